#include "tafoni/io/csv.h"

#include <gmock/gmock.h>

#include "tafoni/core/error.h"
#include "tafoni/core/test/errors.h"

namespace tafoni::io {
namespace {

using ::testing::HasSubstr;

std::string message(std::string_view text) {
  try {
    parse_primitives_csv(text, "p.csv");
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::input);
    return error.what();
  }
  return "no error";
}

TEST(PrimitivesCsv, ReadsRowsInAnyColumnOrder) {
  const auto p = parse_primitives_csv(
      "\xef\xbb\xbf# a comment\r\n"
      "energy, kind ,x,y,z,radius\r\n"
      "\r\n"
      "-7.5,point,500000.125,5500000.0625,+12,5\r\n"
      "  # another\n"
      "1e1,\"Sphere\",1,2,3,0.5",
      "p.csv");
  ASSERT_EQ(p.size(), 2u);
  EXPECT_EQ(p[0].kind->about.name, "point");
  EXPECT_EQ(p[0].position, (Vec3d{500000.125, 5500000.0625, 12}));
  EXPECT_EQ(p[0].energy, -7.5f);
  EXPECT_EQ(p[0].shape, std::vector<float>{5.0f});
  EXPECT_EQ(p[0].line, 4u);
  EXPECT_EQ(p[1].kind->about.name, "sphere");
  EXPECT_EQ(p[1].energy, 10.0f);
  EXPECT_EQ(p[1].line, 6u);
  EXPECT_TRUE(parse_primitives_csv("kind,x,y,z,radius,energy\n", "p").empty());
}

struct Wrong {
  std::string_view text, says;
};
class WrongCsv : public ::testing::TestWithParam<Wrong> {};
TEST_P(WrongCsv, IsAnErrorThatNamesFileLineAndField) {
  EXPECT_EQ(message(GetParam().text), GetParam().says);
}

#define HEADER "kind,x,y,z,radius,energy\n"
INSTANTIATE_TEST_SUITE_P(
    Table, WrongCsv,
    ::testing::Values(
        Wrong{"", "p.csv: is empty; expected a header with the columns kind, x, y, z and energy"},
        Wrong{"# only\n\n", "p.csv: is empty; expected a header with the columns kind, x, y, z and energy"},
        Wrong{"kind,x,y,z,radius\n",
              "p.csv:1: column energy is missing; needed are kind, x, y, z and energy"},
        Wrong{"kind,x,y,z,radius,enrgy\n", "p.csv:1: column \"enrgy\" is not known; did you mean energy?"},
        Wrong{"kind,x,y,z,radius,energy,x\n", "p.csv:1: column x is given twice"},
        Wrong{HEADER "point,1,2,3,4\n", "p.csv:2: has 5 fields where the header has 6"},
        Wrong{HEADER "\nspheer,1,2,3,4,5\n", "p.csv:3: kind is \"spheer\"; did you mean sphere?"},
        Wrong{HEADER "point,1,2,here,4,5\n", "p.csv:2: z is \"here\", which is not a number"},
        Wrong{HEADER "point,1,2,,4,5\n", "p.csv:2: z is \"\", which is not a number"},
        Wrong{HEADER "point,1,2 m,3,4,5\n", "p.csv:2: y is \"2 m\", which is not a number"},
        Wrong{HEADER "point,nan,2,3,4,5\n", "p.csv:2: x is \"nan\", which is not finite"},
        Wrong{HEADER "point,1e999,2,3,4,5\n", "p.csv:2: x is \"1e999\", which is not finite"},
        Wrong{HEADER "point,1,2,3,0,5\n", "p.csv:2: radius = 0 is outside 0.001 to 10000 m"},
        Wrong{HEADER "point,1,2,3,-4,5\n", "p.csv:2: radius = -4 is outside 0.001 to 10000 m"},
        Wrong{HEADER "point,1,2,3,4,1e7\n", "p.csv:2: energy = 10000000 is outside -1000000 to 1000000 m"},
        Wrong{"kind,x,y,z,energy,hx,turn\nbox,1,2,3,4,5,\nbox,1,2,3,4,-5,90\n",
              "p.csv:3: hx = -5 is outside 0 to 10000 m"},
        Wrong{"kind,x,y,z,energy,hx\npoint,1,2,3,4,5\n", "p.csv:2: a point has no hx; leave the field empty"},
        Wrong{"kind,x,y,z,energy\ncurve,1,2,3,4\n",
              "p.csv:2: a curve needs an id: the rows of one id are its vertices"},
        Wrong{"kind,x,y,z,energy,dx,id\ncurve,1,2,3,4,5,a\n",
              "p.csv:2: a curve has no dx; leave the field empty"},
        Wrong{"kind,x,y,z,energy,id\ncurve,1,2,3,4,a\ncurve,1,2,3,4,b\n",
              "p.csv:2: curve \"a\" is one row; give two or more of this id, one a vertex"},
        Wrong{"kind,x,y,z,energy,id\ncurve,1,2,3,4,a\ncurve,1,2,3,5,a\n",
              "p.csv:3: energy and radius differ from those in line 2, where this curve begins"}));

TEST(PrimitivesCsv, KnowsEveryKindByItsOwnParameters) {
  // One row a kind, with a number of its own in every parameter, and one with the defaults.
  for (const field::PrimitiveType* type : field::all_primitives()) {
    if (type->variable) continue;
    std::string header = "kind,x,y,z,energy", row = type->about.name + ",1,2,3,-4";
    std::vector<float> shape, defaults;
    for (const ParamInfo& info : type->about.params) {
      shape.push_back(static_cast<float>(1 + shape.size()));
      defaults.push_back(static_cast<float>(std::get<double>(info.init)));
      header += "," + info.name;
      row += fmt::format(",{}", shape.back());
    }
    const auto given = parse_primitives_csv(header + "\n" + row, "p");
    ASSERT_EQ(given.size(), 1u);
    EXPECT_EQ(given[0].kind, type);
    EXPECT_EQ(given[0].shape, shape) << type->about.name;
    const auto plain = parse_primitives_csv("kind,x,y,z,energy\n" + type->about.name + ",1,2,3,-4", "p");
    EXPECT_EQ(plain.at(0).shape, defaults) << type->about.name;
  }
}

TEST(PrimitivesCsv, ReadsCurvesAsRowsOfOneId) {
  const auto p = parse_primitives_csv(
      "id,kind,x,y,z,energy,radius\n"
      "a,curve,1,2,3,-4,6\na,curve,4,5,6,-4,\na,curve,7,8,9,-4,6\n"
      "b,curve,0,0,0,1,\nb,curve,1,0,0,1,\n"
      ",point,1,1,1,1,\n",
      "p");
  ASSERT_EQ(p.size(), 3u);
  EXPECT_EQ(p[0].further, (std::vector<Vec3d>{{4, 5, 6}, {7, 8, 9}}));
  EXPECT_EQ(p[0].shape, std::vector<float>{6});
  EXPECT_EQ(p[0].line, 2u);
  EXPECT_EQ(p[1].further.size(), 1u);
  EXPECT_EQ(p[2].kind->about.name, "point");
}

TEST(PointsCsv, HeaderChoosesColumnsAndIsOptional) {
  const std::vector<Vec3d> expected = {{1, 2, 3}, {4.5, -6, 7e3}};
  EXPECT_EQ(parse_points_csv("name,z,y,x\na,3,2,1\nb,7000,-6,4.5\n", "q"), expected);
  EXPECT_EQ(parse_points_csv("1,2,3\n4.5,-6,7e3", "q"), expected);
  EXPECT_EQ(parse_points_csv("1,2,3,first\n4.5,-6,7e3,second", "q"), expected);
  EXPECT_TRUE(parse_points_csv("x,y,z\n", "q").empty());
  EXPECT_EQ(parse_points_csv("1e-999,2,3\n", "q").front().x, 0);
}

TEST(PointsCsv, SaysWhatIsWrong) {
  const auto says = [](std::string_view text) {
    try {
      parse_points_csv(text, "q.csv");
    } catch (const Error& error) {
      return std::string(error.what());
    }
    return std::string("no error");
  };
  EXPECT_EQ(says(""), "q.csv: is empty; expected the columns x,y,z");
  EXPECT_EQ(says("1,2\n"), "q.csv:1: has 2 fields; expected x,y,z");
  EXPECT_EQ(says("x,y\n"), "q.csv:1: column z is missing; expected a header with the columns x,y,z");
  EXPECT_EQ(says("x,y,z\n1,2\n"), "q.csv:2: has 2 fields where the first line has 3");
  EXPECT_EQ(says("x,y,z\n1,2,inf\n"), "q.csv:2: z is \"inf\", which is not finite");
}

TEST(Tables, AsProgramsWriteThem) {
  const std::vector<Vec3d> expected = {{447125.4, 5909878.6, 80}, {1.5, -6, 7e3}};
  for (const std::string_view text : {
           "x,y,z\n447125.4,5909878.6,80\n1.5,-6,7e3\n",                        // plain
           "x;y;z\n447125,4;5909878,6;80\n1,5;-6;7e3\n",                        // semicolons, decimal commas
           "x;y;z\n447125.4;5909878.6;80\n1.5;-6;7e3\n",                        // semicolons, points
           "x\ty\tz\n447125,4\t5909878,6\t80\n1,5\t-6\t7e3\n",                  // tabs, decimal commas
           "x\ty\tz\n447125.4\t5909878.6\t80\n1.5\t-6\t7e3\n",                  // tabs
           "x|y|z\n447125.4|5909878.6|80\n1.5|-6|7e3\n",                        // bars
           "x y z\n447125.4 5909878.6   80\n  1.5 -6 7e3  \n",                  // blanks
           "447125.4 5909878.6 80\n1.5 -6 7e3",                                 // blanks, no header
           "447125,4;5909878,6;80\n1,5;-6;7e3",                                 // no header
           "\xef\xbb\xbfx;y;z\r\n447125,4;5909878,6;80\r\n\r\n1,5;-6;7e3\r\n",  // as Excel does
           "sep=;\r\nx;y;z\r\n447125,4;5909878,6;80\r\n1,5;-6;7e3\r\n",         // its first line
           "x,y,z\r447125.4,5909878.6,80\r1.5,-6,7e3\r",                        // old line ends
           "\"x\",\"y\",\"z\"\n\"447125.4\",\"5909878.6\",\"80\"\n\"1.5\",\"-6\",\"7e3\"\n",
           "\"x\",\"y\",\"z\"\n\"447125,4\",\"5909878,6\",\"80\"\n\"1,5\",\"-6\",\"7e3\"\n",
           "name,x,y,z\n\"a, b\",447125.4,5909878.6,80\n\"c \"\"d\"\" e\",1.5,-6,7e3\n",  // commas in quotes
           "name,x,y,z\n\"two\nlines\",447125.4,5909878.6,80\n,1.5,-6,7e3\n",  // a line end in quotes
           "x,y,z,,\n447125.4,5909878.6,80,,\n1.5,-6,7e3,,\n",                 // empty columns
           "X, Y , Z \n 447125.4 , 5909878.6 , 80 \n 1.5 , -6 , 7e3 \n",       // blanks about fields
           "x,\ty,\tz\n447125.4,\t5909878.6,\t80\n1.5,\t-6,\t7e3\n",           // tabs for looks
           "# made by hand\n# twice\nx,y,z\n447125.4,5909878.6,80\n1.5,-6,7e3\n",
       })
    EXPECT_EQ(parse_points_csv(text, "q"), expected) << text;
  std::vector<std::uint32_t> lines;
  constexpr std::string_view columns[] = {"x"};
  parse_numbers_csv("name,x,y\n\"two\nlines\",1,2\n\n\"a\",2,3\n", "q", columns, &lines);
  EXPECT_EQ(lines, (std::vector<std::uint32_t>{2, 5}));
  EXPECT_EQ(parse_primitives_csv("kind;x;y;z;radius;energy\npoint;1,5;2;3;4;-5,25\n", "p").at(0).energy,
            -5.25f);
}

TEST(Tables, SayWhatIsWrong) {
  const auto says = [](std::string_view text) { return error_of([&] { parse_points_csv(text, "q"); }); };
  EXPECT_EQ(
      says("x,y,z\n447125,40,5909878,60,80,0\n"),
      "q:2: has 6 fields where the first line has 3; if its decimal marks are commas, write points, or put "
      "semicolons between the fields");
  EXPECT_EQ(
      says("447125,40,5909878,60,80,0\n"),
      "q:1: has 6 fields where x,y,z are expected; name the columns in the first line; if its decimal marks "
      "are commas, write points, or put semicolons between the fields");
  EXPECT_EQ(says("7,447125.5,5909878.5,80\n"),
            "q:1: has 4 fields where x,y,z are expected; name the columns in the first line");
  EXPECT_EQ(
      says("x,y,z\n1;2;3\n"),
      "q:2: has 1 fields where the first line has 3; its fields are separated by semicolons, unlike those "
      "of the first line");
  EXPECT_EQ(
      says("x,y,z\n1,2,3,4\n"),
      "q:2: has 4 fields where the first line has 3; if its decimal marks are commas, write points, or put "
      "semicolons between the fields");
  EXPECT_EQ(says("x;y;z\n1,5;2;3\n1.5;2;3\n"),
            "q:3: x is \"1.5\", where line 2 has a decimal comma; use one of the two, and nothing between "
            "thousands");
  EXPECT_EQ(says("x;y;z\n5.909.878,6;2;3\n"),
            "q:2: x is \"5.909.878,6\", which is not a number; write it without separators of thousands");
  EXPECT_EQ(
      says("x,y,z\n\"1,234\",2,3\n"),
      "q:2: x is \"1,234\", which is not a number; its comma may be a decimal mark or separate thousands: "
      "write a point or nothing");
  EXPECT_EQ(says("x,y,z\n\"1,2,3\n4,5,6\n"), "q:2: a quote begins here and does not end; close it");
  EXPECT_EQ(
      says("x,y,z\n\"1\"2,2,3\n"),
      "q:2: after the quoted \"1\" there is more text before the next field; double the quotes that belong "
      "to a field");
  EXPECT_EQ(says("x,y,z,X\n1,2,3,4\n"), "q:1: column x is given twice");
  EXPECT_EQ(says(std::string_view("\xff\xfex\0,\0", 6)), "q: is UTF-16 text; save it as UTF-8");
  EXPECT_EQ(says("PK\x03\x04..."), "q: is a spreadsheet or an archive; save the table as CSV");
  EXPECT_EQ(says(std::string_view("x,y,z\n\0,2,3\n", 12)), "q: is not text; save the table as CSV");
}

TEST(ReadText, RefusesWhatIsNoFile) {
  EXPECT_THAT(error_of([] { read_text("/tmp"); }), HasSubstr("/tmp"));
  try {
    read_text("/nonexistent/file.csv");
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), HasSubstr("does not exist"));
  }
}

}  // namespace
}  // namespace tafoni::io
