"""Files: checked before long work, replaced whole or not at all, and read if packed."""

from gym_babble.files.check import check_file, check_folder
from gym_babble.files.read import read_agent
from gym_babble.files.write import write_file, write_files

__all__ = ["check_file", "check_folder", "read_agent", "write_file", "write_files"]
