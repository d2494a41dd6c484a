"""Read by every Python that the command starts: the plugin named by NGSLAC_PLUGIN comes first."""

import os
import sys
from importlib.util import spec_from_file_location


class Instrumented:
    """Finds it where it was built, not where it is installed."""

    @staticmethod
    def find_spec(name, path=None, target=None):
        if name == "ngslac._ngslac":
            return spec_from_file_location(name, os.environ["NGSLAC_PLUGIN"])
        return None


if "NGSLAC_PLUGIN" in os.environ:
    sys.meta_path.insert(0, Instrumented)
