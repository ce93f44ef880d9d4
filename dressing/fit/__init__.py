"""How garments fit: pressure on the body, strain, tension and ease, as maps, tables, pictures and words."""
