"""The conversation of protocol/SPEC.md without I/O: messages, their bytes, the sessions of both sides."""
