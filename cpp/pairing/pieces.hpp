// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include "boxtree.hpp"
#include "pairing.hpp"

namespace ngslac {
/// The faces of a surface, to be searched.
template <int D>
BoxTree<D> FaceTree(const Surface<D> & surface) {
  static Timer timer("ngslac::Pair - tree");
  RegionTimer reg(timer);
  Array<netgen::Box<D>> boxes(surface.Size());
  ParallelFor(surface.Size(), [&](size_t f) { boxes[f] = surface.Bounds(f); });
  return BoxTree<D>(std::move(boxes));
}

/// Does the normal jump between two points of a surface?
template <int D>
bool HaveKink(const Surface<D> & surface, int face, Vec<D - 1> xi, int other, Vec<D - 1> eta) {
  auto normal = [&](int f, Vec<D - 1> at) {
    Vec<D> x;
    Mat<D, D - 1> dx;
    surface.Evaluate(f, at, x, dx);
    return surface.Normal(f, dx);
  };
  return L2Norm2(normal(face, xi) - normal(other, eta)) > 1e-20;
}

/// Runs `pair(range, part)` on pieces of the slave faces in threads and joins the parts in order.
template <int D, typename F>
Pairing<D> InPieces(size_t nfaces, F pair) {
  Array<Pairing<D>> parts(4 * TaskManager::GetNumThreads());
  ParallelJob(
      [&](TaskInfo & ti) {
        pair(IntRange(nfaces).Split(ti.task_nr, ti.ntasks), parts[ti.task_nr]);
      },
      parts.Size());
  // Copied in threads: fresh memory costs more than the copying.
  Array<Segment> offsets(parts.Size() + 1); // where each part begins; slave counts segments
  offsets[0] = Segment{0, -1, 0, 0};
  for (size_t i : Range(parts))
    offsets[i + 1] = Segment{offsets[i].slave + int(parts[i].segments.Size()), -1,
                             offsets[i].first + parts[i].points.Size(),
                             offsets[i].first_corner + parts[i].corners.Size()};
  auto & total = offsets.Last();
  Pairing<D> result;
  for (size_t i : Range(parts))
    for (auto rim : parts[i].rim) {
      rim.segment += offsets[i].slave;
      result.rim.Append(rim);
    }
  result.segments.SetSize(total.slave + 1);
  result.points.SetSize(total.first);
  result.corners.SetSize(total.first_corner);
  result.segments.Last() = Segment{-1, -1, total.first, total.first_corner};
  ParallelFor(parts.Size(), [&](size_t i) {
    Pairing<D> part = std::move(parts[i]);
    for (size_t k : Range(part.segments)) {
      auto & s = part.segments[k];
      result.segments[offsets[i].slave + k] = Segment{s.slave, s.master, s.first + offsets[i].first,
                                                      s.first_corner + offsets[i].first_corner};
    }
    std::copy(part.points.begin(), part.points.end(), result.points.begin() + offsets[i].first);
    std::copy(part.corners.begin(), part.corners.end(),
              result.corners.begin() + offsets[i].first_corner);
  });
  return result;
}
} // namespace ngslac
