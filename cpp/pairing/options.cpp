#include "pairing.hpp"

namespace ngslac {
namespace {
template <int D>
void AddBounds(const Surface<D> & surface, netgen::Box<D> & box) {
  for (size_t f : Range(surface.Size())) {
    auto bounds = surface.Bounds(f);
    box.Add(bounds.PMin());
    box.Add(bounds.PMax());
  }
}
} // namespace

template <int D>
PairingOptions SearchOptions(const Surface<D> & slave, const Surface<D> & master, double maxdist,
                             double penetration, int order) {
  netgen::Box<D> box(netgen::Box<D>::EMPTY_BOX);
  AddBounds(slave, box);
  double own = box.Diam();
  AddBounds(master, box);
  maxdist = maxdist > 0 ? maxdist : box.Diam();
  return {maxdist, penetration > 0 ? penetration : min(maxdist, 0.1 * own), order, nullptr};
}

template PairingOptions SearchOptions(const Surface<2> &, const Surface<2> &, double, double, int);
template PairingOptions SearchOptions(const Surface<3> &, const Surface<3> &, double, double, int);
} // namespace ngslac
