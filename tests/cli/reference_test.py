"""Help, lists, tafoni info, render and generate."""

import json

from case import Case


class Reference(Case):
    def test_help_and_list_cover_everything(self):
        help_text = self.passes("--help")
        listed = json.loads(self.passes("list", "--json"))
        page = self.passes("list", "--markdown")
        for command in listed["commands"]:
            self.assertIn(command["name"], help_text)
            self.assertIn(command["doc"][:40], self.passes(command["name"], "--help"))
        for topic, entries in listed.items():
            for entry in entries:
                self.assertIn(f"### {entry['name']}\n", page)
                self.assertTrue(entry["doc"], f"{topic} {entry['name']}")
                for param in entry.get("params", []):
                    self.assertTrue(param["doc"], f"{entry['name']}.{param['name']}")
                    self.assertIn(f"`{param['name']}`", page)


class Info(Case):
    def test_info_reads_terrain_and_scene(self):
        self.hill()
        self.assertEqual(json.loads(self.passes("info", "hill.asc", "--json"))["width"], 40)
        (self.dir / "s.toml").write_text("[terrain]\nsource = 'hill.asc'\n[[layer]]\ntype = 'karst'\nenabled = false\n")
        self.assertIn("karst (off)", self.passes("info", "s.toml"))
        self.assertEqual(json.loads(self.passes("info", "s.toml", "--json"))["source"]["width"], 40)


class Render(Case):
    def test_render_cuts_the_rock_open(self):
        self.hill()
        (self.dir / "s.toml").write_text("[scene]\nvoxel = 4\n[terrain]\nsource = 'hill.asc'\n[[geology]]\n"
                                         "type = 'fold'\n[[geology.of]]\ntype = 'strata'\n")
        small = ("--size", "64,48", "--samples", "1")
        self.passes("render", "s.toml", "--geology", "-o", "a.png", *small)
        self.passes("render", "s.toml", "--geology", "--set", "strata.dip=30", "-o", "b.png", *small)
        self.assertNotEqual((self.dir / "a.png").read_bytes(), (self.dir / "b.png").read_bytes())
        self.fails(2, "needs --geology", "render", "s.toml", "--cut", "0,0,1,1", "-o", "c.png")
        self.fails(2, "Nothing of the terrain", "render", "s.toml", "--geology", "--cut", "0,1e6,1,1e6", "-o", "c.png")
        self.fails(2, "exclude", "render", "s.toml", "--geology", "--inside", "-o", "c.png")
        (self.dir / "t.toml").write_text("[terrain]\nsource = 'hill.asc'\n[[geology]]\ntype = 'fold'\n")
        self.fails(3, "t.toml:4: fold: takes 1 child, but has none", "build", "t.toml", "-o", "c.glb")


class Generate(Case):
    def test_generate_is_reproducible(self):
        for name in ("a.tif", "b.tif"):
            self.passes("generate", "coast", "-o", name, "--seed", "3", "--set", "width=64", "--set", "coast.height=48")
        self.assertEqual((self.dir / "a.tif").read_bytes(), (self.dir / "b.tif").read_bytes())
