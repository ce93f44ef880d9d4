"""Fields of garments: what users say of parts of a garment, found on its pattern and cut into its mesh."""
