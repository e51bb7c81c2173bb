#!/usr/bin/env python3
"""Prints the man page of a program `billow`, from the help of its commands:  man_page.py BILLOW"""

import re
import subprocess
import sys


def output(*arguments):
    return subprocess.run([sys.argv[1], *arguments], check=True, capture_output=True, text=True).stdout


def verbatim(text):
    lines = (line.replace("\\", "\\e") for line in text.rstrip().splitlines())
    # A line that begins with a dot or a quote would be a request.
    return ".nf\n" + "\n".join(f"\\&{line}" if line[:1] in (".", "'") else line for line in lines) + "\n.fi"


def main():
    version = output("--version").split()[1]
    overview = output("--help")
    about = overview.splitlines()[0].rstrip(".").replace("\\", "\\e")
    # Groups of commands stand before the options, each command as "  name  what it does".
    commands = re.findall(r"^  ([a-z]+) ", overview.split("\nOptions:\n")[0], re.MULTILINE)
    assert "run" in commands, overview
    print(f'.TH BILLOW 1 "" "billow {version}" "User Commands"')
    print(f".SH NAME\nbillow \\- {about}")
    print(".SH OVERVIEW\n" + verbatim(overview))
    for command in commands:
        print(f".SH BILLOW {command.upper()}\n" + verbatim(output(command, "--help")))


if __name__ == "__main__":
    main()
