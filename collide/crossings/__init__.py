"""Which faces of surfaces meet, by exact arithmetic; nothing here is shared with search and guard."""
