"""The process that takes frames as a page does, and draws nothing."""

import sys
from urllib.parse import urlsplit


def main() -> None:
    """Take frames from a server at the address given until it goes."""
    from websockets.exceptions import ConnectionClosed
    from websockets.sync.client import connect

    parts = urlsplit(sys.argv[1])
    own = f"http://{parts.netloc}"
    with connect(f"ws://{parts.netloc}{parts.path}talk", origin=own) as page:
        try:
            for message in page:
                if isinstance(message, bytes):
                    page.send("drawn")
        except ConnectionClosed:
            return


if __name__ == "__main__":
    main()
