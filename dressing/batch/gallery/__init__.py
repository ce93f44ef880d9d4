"""Pages that show the results of a batch: pictures, filters, 3-D views, a summary. They open from disk."""
