"""Effects of contributors on measures: who acts, slopes, ends, regions and worst cases, before any statistics."""
