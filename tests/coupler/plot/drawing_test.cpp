#include "coupler/plot/drawing.hpp"

#include "coupler/plot/canvas.hpp"
#include "coupler/plot/scene.hpp"
#include "coupler/plot/ticks.hpp"

#include <Eigen/Geometry>
#include <cairo.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

namespace strake {
namespace drawing_test {

using picture::Colour;

double linear(double c) {
  return c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4);
}
/// Relative luminance of sRGB.
double luminance(const Colour& c) {
  return 0.2126 * linear(c.red) + 0.7152 * linear(c.green) + 0.0722 * linear(c.blue);
}

TEST(ColourMap, GrowsLighterAllTheWayAndStaysInsideWhatAScreenShows) {
  for (const auto map : {picture::water_colour, picture::solid_colour}) {
    double before = -1;
    for (int k = 0; k <= 255; ++k) {
      const Colour c = map(k / 255.0);
      EXPECT_GT(luminance(c), before) << k;
      before = luminance(c);
      for (const double part : {c.red, c.green, c.blue}) {
        EXPECT_GE(part, 0);
        EXPECT_LE(part, 1);
      }
    }
    EXPECT_EQ(map(-3).red, map(0).red);
    EXPECT_EQ(map(7).blue, map(1).blue);
  }
}

TEST(ColourMap, OklabOfWhiteGreyAndRedAreThoseOfSrgb) {
  const Colour white = picture::from_oklch(1, 0, 0);
  EXPECT_NEAR(white.red, 1, 1e-3);
  EXPECT_NEAR(white.blue, 1, 1e-3);
  const Colour red = picture::from_oklch(0.627955, 0.257683, 29.2339);  // #ff0000
  EXPECT_NEAR(red.red, 1, 2e-3);
  EXPECT_NEAR(red.green, 0, 1e-2);
  EXPECT_NEAR(red.blue, 0, 1e-2);
}

TEST(Ticks, AreRoundAndWithinTheRange) {
  EXPECT_EQ(round_ticks(0, 1, 5), (std::vector<double>{0, 0.2, 0.4, 0.6000000000000001, 0.8, 1}));
  const auto ticks = round_ticks(-0.37e-3, 1.9e-3, 5);
  EXPECT_EQ(ticks.size(), 4U);
  EXPECT_DOUBLE_EQ(ticks.front(), 0);
  EXPECT_DOUBLE_EQ(ticks.back(), 1.5e-3);
  EXPECT_TRUE(round_ticks(1, 1, 5).empty());
  EXPECT_TRUE(round_ticks(0, std::nan(""), 5).empty());
}

TEST(Ticks, UnitsTakeThePrefixThatMakesTheNumberReadable) {
  EXPECT_EQ(with_prefix(prefix_for(9.2e6, "Pa"), "Pa"), "MPa");
  EXPECT_EQ(with_prefix(prefix_for(-1.7e-3, "m"), "m"), "mm");
  EXPECT_EQ(with_prefix(prefix_for(3e-4, "1"), "1"), "");
  EXPECT_EQ(with_prefix(prefix_for(3e-4, "m^2"), "m^2"), "m^2");
  EXPECT_EQ(with_prefix(prefix_for(0, "s"), "s"), "s");
  EXPECT_EQ(tick_text(0.25, 0.05), "0.25");
  EXPECT_EQ(tick_text(300, 100), "300");
}

TEST(Scene, TheShownRangeLeavesOutSpikesAndBeginsAtZeroWhereThatIsNear) {
  std::vector<double> values(1000, 0);
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = -1 + 0.1 * static_cast<double>(i);
  values[0] = -1e9;
  values[999] = 1e9;
  const picture::Range range = picture::shown_range(values);
  EXPECT_EQ(range.lo, 0);
  EXPECT_NEAR(range.hi, 98.4, 0.2);
  EXPECT_TRUE(picture::shown_range({}).empty());
  const picture::Range one = picture::shown_range({5, 5, 5});
  EXPECT_LT(one.lo, one.hi);
}

TEST(Scene, TheSpacingOfALatticeIsFoundFromItsPoints) {
  Frame frame;
  frame.position = Points::Zero(3, 20);  // columns of four
  for (Eigen::Index i = 0; i < 20; ++i)
    frame.position.col(i) << 0.002 * static_cast<double>(i / 4), 0.002 * static_cast<double>(i % 4), 0;
  EXPECT_NEAR(picture::lattice_spacing(frame), 0.002, 1e-15);
  EXPECT_EQ(picture::lattice_spacing(Frame{}), 0);
}

TEST(Scene, TheDeformationOfAFreeBodyIsWithoutItsRigidMotion) {
  Points before(3, 5);
  before << 0, 1, 2, 1, 0.3, 0, 0.1, 0, -0.4, 0.2, 0, 0, 0, 0, 0;
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(0.4, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  Frame frame;
  frame.time = 0.5;
  frame.position = (turn * before).colwise() + Eigen::Vector3d(3, -2, 0);
  frame.point_data = {{"displacement", "m", frame.position - before}};
  const std::map<std::string, std::string> free = {{"structure.velocity", "[0,-4,0]"},
                                                   {"structure.free.y", "true"}};
  EXPECT_LT(picture::deformation(free, frame)->norm(), 1e-14);
  // Points that move apart evenly: the fit leaves that alone.
  frame.position.col(0) += turn * Eigen::Vector3d(-1e-3, 0, 0);
  frame.position.col(2) += turn * Eigen::Vector3d(1e-3, 0, 0);
  frame.point_data[0].value = frame.position - before;
  const Points bend = *picture::deformation(free, frame);
  EXPECT_NEAR(bend.col(2).norm(), 1e-3, 3e-4);
  EXPECT_LT(bend.norm(), 2e-3);
  // Driven supports go V t; the rest is deformation.
  frame.position = before.colwise() + Eigen::Vector3d(0, -2, 0);
  frame.point_data[0].value = frame.position - before;
  EXPECT_LT(picture::deformation({{"structure.velocity", "[0,-4,0]"}}, frame)->norm(), 1e-14);
  EXPECT_FALSE(picture::deformation({}, Frame{}));
}

TEST(Section, OfACubeIsASquareAndOfAFacetALine) {
  Points p(3, 8);
  p << 0, 1, 1, 0, 0, 1, 1, 0,  //
      0, 0, 1, 1, 0, 0, 1, 1,   //
      0, 0, 0, 0, 1, 1, 1, 1;
  Eigen::VectorXi cube(8), facet(3);
  cube << 0, 1, 2, 3, 4, 5, 6, 7;
  facet << 0, 1, 5;
  const auto square = picture::section(p, cube, 0.3);
  ASSERT_EQ(square.size(), 4U);
  double area = 0;
  for (std::size_t i = 0; i < 4; ++i)
    area += 0.5 * (square[i].x * square[(i + 1) % 4].y - square[i].y * square[(i + 1) % 4].x);
  EXPECT_NEAR(area, 1, 1e-12);
  EXPECT_EQ(picture::section(p, facet, 0.5).size(), 2U);
  EXPECT_TRUE(picture::section(p, cube, 2).empty());
}

/// Counts the white pixels in a part of a picture.
int white_pixels(std::string png, int left, int top, int right, int bottom) {
  const auto read = [](void* rest, unsigned char* bytes, unsigned int length) {
    auto& text = *static_cast<std::string*>(rest);
    std::copy_n(text.begin(), length, bytes);
    text.erase(0, length);
    return CAIRO_STATUS_SUCCESS;
  };
  cairo_surface_t* image = cairo_image_surface_create_from_png_stream(read, &png);
  int white = 0;
  for (int y = top; y < bottom; ++y)
    for (int x = left; x < right; ++x) {
      const unsigned char* p =
          cairo_image_surface_get_data(image) + y * cairo_image_surface_get_stride(image) + 4 * x;
      white += p[0] == 255 && p[1] == 255 && p[2] == 255 ? 1 : 0;
    }
  cairo_surface_destroy(image);
  return white;
}

// A floor, and a turned block of particles above it, at many sizes of a pixel.
TEST(Drawing, ParticlesOfWallsAndTurnedBodiesLeaveNoGaps) {
  picture::Scene scene;
  scene.spacing = scene.solid_spacing = 0.01;
  constexpr int n = 100;
  for (int i = 0; i < n; ++i) scene.wall.push_back({{-0.495 + 0.01 * i, -0.505}, 0});
  const double c = std::cos(0.3), s = std::sin(0.3);
  for (int i = -30; i <= 30; ++i)
    for (int j = -30; j <= 30; ++j)
      scene.solid.push_back({{0.01 * (c * i - s * j), 0.01 * (s * i + c * j)}, 0});
  for (int width = 400; width < 960; width += 37) {
    picture::DrawingOptions options;
    options.width = width;
    options.view = picture::View{-0.5, -0.51, 0.5, 0.5};
    const std::string png = picture::draw(scene, options, picture::Canvas::Kind::png);
    const double scale = width - 80;  // [px/m]
    const auto x = [&](double at) { return static_cast<int>(62 + scale * (at + 0.5)); };
    const auto y = [&](double at) { return static_cast<int>(58 + scale * (0.5 - at)); };
    EXPECT_EQ(white_pixels(png, x(-0.49), y(-0.503), x(0.49), y(-0.505)), 0) << width;
    EXPECT_EQ(white_pixels(png, x(-0.2), y(0.2), x(0.2), y(-0.2)), 0) << width;
  }
}

TEST(Canvas, WritesWholeFilesOfEitherKind) {
  for (const auto kind : {picture::Canvas::Kind::png, picture::Canvas::Kind::svg}) {
    picture::Canvas canvas(kind, 64, 48);
    canvas.begin_image(4, 4, 40, 40);
    canvas.dot(10, 10, 3, {1, 0, 0});
    canvas.end_image();
    canvas.text(5, 40, "α & <β>", 12);
    const std::string bytes = canvas.finish();
    if (kind == picture::Canvas::Kind::png) {
      EXPECT_TRUE(bytes.starts_with("\x89PNG"));
      EXPECT_NE(bytes.find("IEND"), std::string::npos);
    } else {
      EXPECT_NE(bytes.find("<svg"), std::string::npos);
      EXPECT_NE(bytes.find("</svg>"), std::string::npos);
    }
  }
}

}  // namespace drawing_test
}  // namespace strake
