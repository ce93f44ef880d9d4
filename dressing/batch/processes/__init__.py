"""Processes that run the jobs of a batch: isolated, limited, on one machine or on Dask."""
