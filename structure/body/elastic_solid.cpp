#include "structure/body/parameters.hpp"

namespace strake::structure {

// The plate is a union of one box.
Solid elastic_solid(const Parameters& p) {
  if (!p.solid.empty()) return p.solid;
  const Plate& plate = p.plate;
  SolidBox box;
  box.name = "plate";
  box.material = p.material;
  const double half = 0.5 * plate.length;
  box.min << plate.bottom.x() - half, plate.bottom.y(), p.shape.middle - 0.5 * p.shape.depth;
  box.max << plate.bottom.x() + half, plate.bottom.y() + plate.thickness,
      p.shape.middle + 0.5 * p.shape.depth;
  box.support[0] = plate.left;
  box.support[1] = plate.right;
  return solid_of_boxes(p.dimension, {box});
}

}  // namespace strake::structure
