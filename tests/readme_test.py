"""What the README shows is what the project has: its C++ is from examples/, its files and pages exist."""

import os
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

root = Path(os.environ["TAFONI_SOURCE_DIR"])
problems = []

readme = (root / "README.md").read_text(encoding="utf-8")
blocks = re.findall(r"```cpp\n(.*?)```", readme, re.S)
if not blocks or blocks[0] != (root / "examples/readme.cpp").read_text(encoding="utf-8"):
    problems.append("README.md: its first C++ block is not examples/readme.cpp, letter for letter")
programs = [path.read_text(encoding="utf-8") for path in (root / "examples").glob("*.cpp")]
for block in blocks[1:]:
    if not any(block in program for program in programs):
        problems.append(f"README.md: no program of examples/ has the lines {block[:60]!r}…")

# Where links lead is checked by tools/check-sources.
for page in [root / "README.md", root / "CONTRIBUTING.md", root / "THIRD_PARTY.md", *sorted((root / "docs").glob("*.md")),
             *sorted((root / "src").glob("tafoni/**/README.md"))]:
    text = page.read_text(encoding="utf-8")
    # `path/file.ext` in the running text names a file of the tree; what a program writes is not one.
    for target in re.findall(r"`((?:src|tools|cmake|tests|bench|examples|apps|docs)/[\w./-]*\w)`", text):
        if "NAME" not in target and not (root / target).exists():
            problems.append(f"{page.relative_to(root)}: names {target}, which does not exist")

# The commands of the README run as they stand, from the folder of a clone: here a folder with its examples.
commands = next(block for block in re.findall(r"```sh\n(.*?)```", readme, re.S) if "tafoni amplify" in block)
with tempfile.TemporaryDirectory() as folder:
    shutil.copytree(root / "examples", Path(folder) / "examples")
    path = f"{Path(os.environ['TAFONI_CLI']).parent}:{os.environ['PATH']}"
    for command in commands.replace("\\\n", " ").splitlines():
        if command.startswith("export PATH="):
            continue
        done = subprocess.run(["bash", "-c", command], cwd=folder, env={**os.environ, "PATH": path}, capture_output=True, text=True)
        if done.returncode != 0:
            problems.append(f"README.md: {command!r} fails: {done.stderr}")

for line in problems:
    print(line, file=sys.stderr)
sys.exit(1 if problems else 0)
