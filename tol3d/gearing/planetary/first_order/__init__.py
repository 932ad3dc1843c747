"""The analytic method of planetary sets: contacts by gaps to first order."""
