#pragma once
#include "pairing.hpp"

namespace ngslac {
/// Runs `pair(range, part)` on pieces of the slave faces in threads and joins the parts in order.
template <int D, typename F>
Pairing<D> InPieces(size_t nfaces, F pair) {
  Array<Pairing<D>> parts(4 * TaskManager::GetNumThreads());
  ParallelJob(
      [&](TaskInfo & ti) {
        pair(IntRange(nfaces).Split(ti.task_nr, ti.ntasks), parts[ti.task_nr]);
      },
      parts.Size());
  size_t segments = 1, points = 0, corners = 0;
  for (auto & part : parts)
    segments += part.segments.Size(), points += part.points.Size(), corners += part.corners.Size();
  Pairing<D> result;
  result.segments.SetAllocSize(segments);
  result.points.SetAllocSize(points);
  result.corners.SetAllocSize(corners);
  for (auto & part : parts) {
    points = result.points.Size(), corners = result.corners.Size();
    for (auto & s : part.segments)
      result.segments.Append(
          Segment{s.slave, s.master, s.first + points, s.first_corner + corners});
    result.points += part.points;
    result.corners += part.corners;
    part = Pairing<D>();
  }
  result.segments.Append(Segment{-1, -1, result.points.Size(), result.corners.Size()});
  return result;
}
} // namespace ngslac
