"""Bodies whose parts move on prescribed joints."""
