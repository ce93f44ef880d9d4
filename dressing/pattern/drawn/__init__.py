"""Patterns as they are drawn, without seams: pieces, halves on the fold, pairs, notches; DXF and FreeSewing."""
