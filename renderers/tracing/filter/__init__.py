"""From samples to pixels: visibility filters, antialiased edges."""
