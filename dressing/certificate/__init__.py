"""Certificates: what a result was made from and how it was audited, so that others can check it again."""
