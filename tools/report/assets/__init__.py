"""What goes into the page as it is: style, script and frame of the 3-D view."""
