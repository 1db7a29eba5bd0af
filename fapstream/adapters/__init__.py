"""One module for each thing outside: voices, sound card, clock, files. They stand behind `ports`."""
