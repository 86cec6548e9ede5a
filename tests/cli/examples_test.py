"""The scenes of examples/ and what they say of themselves."""

import os
import re
from pathlib import Path

from case import Case


class Examples(Case):
    def test_every_example_scene_builds(self):
        for example in sorted((Path(os.environ["TAFONI_SOURCE_DIR"]) / "examples").glob("*.toml")):
            own = float(re.search(r"^voxel = ([0-9.]+)", example.read_text(), re.M).group(1))
            self.passes("build", example, "--voxel", max(4, 4 * own), "--boundary", "solid", "-o", "a.glb")
            self.passes("validate", "a.glb", "--closed")

    def test_every_example_says_how_its_picture_is_made(self):
        for example in (Path(os.environ["TAFONI_SOURCE_DIR"]) / "examples").glob("*.toml"):
            heading = re.match(r"(#.*\n)+", example.read_text()).group(0)
            self.assertRegex(heading, rf"#   tafoni render examples/{example.name} .*-o docs/images/\w[\w-]*\.jpg\n")
