"""Reports of a balancing job: text, JSON, a log as CSV, and the certificate as HTML."""
