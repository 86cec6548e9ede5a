"""The scenes of examples/ and what they say of themselves."""

import json
import os
import re
from pathlib import Path

from case import Case


class Examples(Case):
    def test_every_example_scene_builds(self):
        for example in sorted((Path(os.environ["TAFONI_SOURCE_DIR"]) / "examples").glob("*.toml")):
            own = float(re.search(r"^voxel = ([0-9.]+)", example.read_text(), re.M).group(1))
            # Sanitized programs, a tenth as fast, build coarser ones.
            coarse = 4 * float(os.environ.get("TAFONI_COARSER", 1))
            self.passes("build", example, "--voxel", max(4, coarse * own), "--boundary", "solid", "-o", "a.glb")
            self.passes("validate", "a.glb", "--closed")

    def test_volumes_of_examples_are_what_their_commands_make(self):
        examples = Path(os.environ["TAFONI_SOURCE_DIR"]) / "examples"
        (self.dir / "examples").mkdir()
        for volume in examples.glob("*.tvol"):
            heading = re.match(r"(#.*\n)+", volume.with_suffix(".toml").read_text()).group(0)
            for command in re.findall(r"#   tafoni (.*)", heading):
                if "docs/images" not in command:
                    self.passes(*command.split())
            made, kept = (json.loads(self.passes("metrics", path, "--json"))
                          for path in (self.dir / "examples" / volume.name, volume))
            self.assertEqual(made["genus"], kept["genus"])
            self.assertAlmostEqual(made["volume"] / kept["volume"], 1, delta=1e-4)
            self.assertAlmostEqual(made["area"] / kept["area"], 1, delta=1e-4)

    def test_every_example_says_how_its_picture_is_made(self):
        for example in (Path(os.environ["TAFONI_SOURCE_DIR"]) / "examples").glob("*.toml"):
            heading = re.match(r"(#.*\n)+", example.read_text()).group(0)
            self.assertRegex(heading, rf"#   tafoni render examples/{example.name} .*-o docs/images/\w[\w-]*\.jpg\n")
