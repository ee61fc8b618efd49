"""Writing files: checked before long work, and replaced whole or not at all."""

from gym_babble.files.check import check_file, check_folder
from gym_babble.files.write import write_file, write_files

__all__ = ["check_file", "check_folder", "write_file", "write_files"]
