"""Results as pages that one turns in a browser: without a server, without a library, from one file."""
