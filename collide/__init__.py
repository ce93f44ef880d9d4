"""Avatar and cloth surfaces in, close pairs and safe moves out."""
