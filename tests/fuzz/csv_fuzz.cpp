// Any text is either a table or one error of kind input; a table is never larger than its text.

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <string_view>
#include <vector>

#include "tafoni/core/error.h"
#include "tafoni/io/csv.h"

/// For mutate_main.cpp and as a first corpus.
std::vector<std::string> fuzz_seeds();
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

namespace {

template <class F>
void check(F&& parse) {
  try {
    parse();
  } catch (const tafoni::Error& error) {
    if (error.kind() != tafoni::ErrorKind::input) std::abort();
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  check([&] {
    for (const auto& p : tafoni::io::parse_primitives_csv(text, "fuzz.csv"))
      if (p.shape.empty() || !(p.shape[0] > 0) || !std::isfinite(p.position.x) || !std::isfinite(p.energy))
        std::abort();
  });
  check([&] {
    if (tafoni::io::parse_points_csv(text, "fuzz.csv").size() > size) std::abort();
  });
  return 0;
}
