"""The exact method of a cycloid stage: contacts in finite geometry."""
