"""The exact road of a cycloid stage: contacts in finite geometry."""
