"""Puts the program of BILLOW_PROGRAM, the one of `make dist`, into the wheel, which is then of one platform."""

import os
import sysconfig

from hatchling.builders.hooks.plugin.interface import BuildHookInterface


class Program(BuildHookInterface):
    """The hook that hatchling calls."""

    def initialize(self, version, build_data):
        platform = sysconfig.get_platform().replace("-", "_").replace(".", "_")
        build_data["pure_python"] = False
        build_data["tag"] = f"py3-none-{platform}"
        build_data["shared_scripts"][os.environ["BILLOW_PROGRAM"]] = "billow"
