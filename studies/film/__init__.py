"""Films and drapes of garments, side by side with another version of toile and with Blender's cloth."""
