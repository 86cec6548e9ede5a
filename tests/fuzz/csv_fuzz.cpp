// Any text is either a table or one error of kind input; a table is never larger than its text.

#include "fuzz.h"

#include "tafoni/io/csv.h"

std::vector<std::string> fuzz_seeds() {
  return {"# spheres\nkind,x,y,z,radius,energy\npoint,500000.5,5500000.25,12,5,-7.5\nsphere,1,2,3,0.5,1e1\n",
          "x,y,z\n1,2,3\n4.5,-6,7e3\n",
          "kind,x,y,z,energy,id,hx,turn\nbox,1,2,3,4,,5,90\ncurve,1,2,3,-4,a,,\ncurve,4,5,6,-4,a,,\n",
          "\xef\xbb\xbf"
          "energy,radius,z,y,x,kind\r\n1,2,3,4,5,point\r\n",
          "sep=;\r\nname;x;y;z\r\n\"a; \"\"b\"\"\";447125,40;5909878,60;80\r\n\"two\nlines\";1,5;-6;7e3\r\n",
          "x\ty\tz\n447125,40\t5909878,60\t80\n",
          "x y z\n1  2 3 \n\"4\" 5 6\n",
          "1|2|3|a\r4|5|6|b\r"};
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace tafoni;
  const std::string_view text = as_text(data, size);
  accepts([&] {
    for (const auto& p : io::parse_primitives_csv(text, "fuzz.csv"))
      require(!p.shape.empty() && p.shape[0] > 0 && std::isfinite(p.position.x) && std::isfinite(p.energy));
  });
  accepts([&] { require(io::parse_points_csv(text, "fuzz.csv").size() <= size); });
  accepts([&] {
    constexpr std::string_view columns[] = {"x", "y", "z", "radius"};
    std::vector<std::uint32_t> lines;
    const auto rows = io::parse_numbers_csv(text, "fuzz.csv", columns, &lines);
    require(rows.size() <= size && lines.size() == rows.size());
    for (const auto& row : rows)
      for (const double v : row) require(row.size() == std::size(columns) && std::isfinite(v));
  });
  return 0;
}
