"""Patterns as they are drawn, without seams: pieces, folds, pairs, notches; DXF and FreeSewing."""
