// SPDX-License-Identifier: LGPL-2.1-or-later
#include "partition.hpp"
#include "traces.hpp"
#include <queue>

namespace ngslac {
namespace {
constexpr double bend_cosine = 0.5; // faces of a macro-element bend by less than 60 degrees

/// How many faces a macro-element may have that was made from a support of this many: about those
/// of one more layer.
size_t Limit(int dim, size_t support) {
  return dim == 2 ? support + 2 : max(size_t(4), 2 * support + 1);
}

Reach ReachOf(const Traces & tr, FlatArray<int> dofs) {
  Reach reach;
  for (int dof : dofs)
    reach.Add(tr.dof_mean[dof]);
  return reach;
}

/// Do these dofs reach all directions in which anything inside can move the faces, and the normals
/// among them?
bool Controls(const Traces & tr, FlatArray<int> dofs, FlatArray<int> faces) {
  Reach own = ReachOf(tr, dofs), all = own;
  for (int s : faces)
    all.Add(tr.reach[s]);
  return own.Rank() == all.Rank() &&
         std::all_of(faces.begin(), faces.end(), [&](int s) { return own.Reaches(tr.normals[s]); });
}

bool Bends(const Traces & tr, FlatArray<int> faces) {
  for (int s : faces)
    for (int t : faces)
      if (InnerProduct(tr.normals[s], tr.normals[t]) < bend_cosine)
        return true;
  return false;
}

/// The free dofs that share one support.
using Candidate = Array<int>;

FlatArray<int> Support(const Traces & tr, const Candidate & candidate) {
  return tr.dof_faces[candidate[0]];
}

/// All supports on which the free dofs reach every direction that is not prescribed.
Array<Candidate> FindCandidates(const Traces & tr) {
  std::map<std::vector<int>, int> index;
  Array<Candidate> all;
  for (size_t dof : Range(tr.dof_faces)) {
    auto faces = tr.dof_faces[dof];
    if (faces.Size() == 0 || !tr.inner_dofs.Test(dof))
      continue;
    auto [it, isnew] =
        index.try_emplace(std::vector<int>(faces.begin(), faces.end()), int(all.Size()));
    if (isnew)
      all.Append(Candidate());
    all[it->second].Append(dof);
  }
  Array<Candidate> usable;
  for (auto & c : all)
    if (Controls(tr, c, Support(tr, c)) && !Bends(tr, Support(tr, c)))
      usable.Append(std::move(c));
  return usable;
}

/// Disjoint supports, the smallest first; among equals the one that excludes the fewest others, so
/// that the choice advances from the rim and leaves few gaps.
Array<int> ChooseDisjoint(const Traces & tr, FlatArray<Candidate> candidates) {
  TableCreator<int> creator(tr.faces.Size());
  for (; !creator.Done(); creator++)
    for (int c : Range(candidates))
      for (int s : Support(tr, candidates[c]))
        creator.Add(s, c);
  auto at_face = creator.MoveTable();

  auto conflicts = [&](int c, auto f) {
    for (int s : Support(tr, candidates[c]))
      for (int other : at_face[s])
        if (other != c)
          f(other);
  };
  Array<int> degree(candidates.Size());
  Array<bool> open(candidates.Size());
  using Entry = std::tuple<size_t, int, int>; // number of faces, conflicts, candidate
  std::priority_queue<Entry, std::vector<Entry>, std::greater<Entry>> queue;
  for (int c : Range(candidates)) {
    degree[c] = 0, open[c] = true;
    conflicts(c, [&](int) { degree[c]++; });
    queue.emplace(Support(tr, candidates[c]).Size(), degree[c], c);
  }
  Array<int> chosen;
  while (!queue.empty()) {
    auto [size, deg, c] = queue.top();
    queue.pop();
    if (!open[c] || deg != degree[c])
      continue;
    chosen.Append(c);
    open[c] = false;
    conflicts(c, [&](int excluded) {
      if (!open[excluded])
        return;
      open[excluded] = false;
      conflicts(excluded, [&](int other) {
        if (open[other])
          queue.emplace(Support(tr, candidates[other]).Size(), --degree[other], other);
      });
    });
  }
  return chosen;
}

Vec<3> FaceCenter(const MeshAccess & ma, int face) {
  Vec<3> center = 0.0;
  auto vertices = ma.GetElement(ElementId(BND, face)).Vertices();
  for (auto v : vertices) {
    auto p = ma.GetPoint<3>(v);
    center += 1.0 / vertices.Size() * p;
  }
  return center;
}

[[noreturn]] void ThrowUnstable(const FESpace & fes, const Traces & tr, FlatArray<int> faces) {
  auto ma = fes.GetMeshAccess();
  bool moves = std::any_of(faces.begin(), faces.end(), [&](int s) { return tr.movable[s]; });
  stringstream text;
  text << "LACSpace: no macro-element can be made of " << faces.Size() << " face(s) of boundary '"
       << tr.faces.Name(faces[0]) << "', the first at " << FaceCenter(*ma, tr.faces[faces[0]]);
  if (std::all_of(faces.begin(), faces.end(), [&](int s) { return tr.bare[s]; }))
    throw Exception(text.str() + ": V, a space of type " + fes.GetClassName() +
                    ", has no dofs there. Remedy: a space with traces on the boundary, such as "
                    "VectorH1, that is defined on this body");
  if (moves)
    text << ": no free displacement dof has its whole trace on them, so that the multiplier would "
            "be unstable. ";
  else
    text << ": no displacement is free there along the normal, so that contact cannot push them. ";
  text << "Remedy: SplitSlaveFaces(mesh, slave), BubbleVectorH1(mesh, slave=...), a higher order, "
          "or "
          "no Dirichlet condition on the slave faces";
  if (!moves)
    text << " for the component along their normal (or make the other surface the slave)";
  throw Exception(text.str());
}

/// Slave faces on the way into groups.
struct Groups {
  Array<int> of_face; // -1: none yet
  Array<size_t> size, limit;
  Array<int> first; // face that decides on the order

  void Add(FlatArray<int> faces, size_t alimit) {
    for (int s : faces)
      of_face[s] = size.Size();
    size.Append(faces.Size()), limit.Append(alimit), first.Append(faces[0]);
  }
  void AddFaces(const BitArray & faces) {
    for (int s : Range(of_face))
      if (faces.Test(s) && of_face[s] < 0)
        Add(FlatArray<int>(1, &s), 0);
  }
  /// Numbered in the order of the mesh: neighbours get close numbers.
  Array<int> Numbers() const {
    Array<int> order(first.Size()), number(first.Size()), result(of_face.Size());
    for (int g : Range(order))
      order[g] = g;
    QuickSort(order, [&](int a, int b) { return first[a] < first[b]; });
    for (int i : Range(order))
      number[order[i]] = i;
    for (int s : Range(result))
      result[s] = number[of_face[s]];
    return result;
  }
};

/// The requirements of a left-over face on the group that it joins.
struct Wishes {
  bool small = false;   // it is below its limit
  bool reaches = false; // its support moves wherever the face moves
  bool flat = false;    // none of its faces bends away
};

/// Joins faces that are left over to groups of their neighbours.
class Leftovers {
  const Traces & tr;
  Groups & groups;
  FlatArray<Reach> reach;  // of the support in each group
  Array<Array<int>> faces; // of each group

public:
  Leftovers(const Traces & atr, Groups & agroups, FlatArray<Reach> areach)
      : tr(atr), groups(agroups), reach(areach), faces(areach.Size()) {
    for (int s : Range(groups.of_face))
      if (groups.of_face[s] >= 0)
        faces[groups.of_face[s]].Append(s);
  }

  /// One after the other, as long as there is a group that is not too large.
  void JoinSmall(const Wishes & wishes) {
    for (bool changed = true; changed;) {
      changed = false;
      for (int s : Range(groups.of_face))
        if (int g = Best(s, wishes); g >= 0) {
          groups.size[g]++;
          Put(s, g);
          changed = true;
        }
    }
  }

  /// Joins the faces that can move layer by layer, however large groups become.
  void JoinMovable(const Wishes & wishes) {
    Array<pair<int, int>> layer;
    do {
      layer.SetSize0();
      for (int s : Range(groups.of_face))
        if (int g = tr.movable[s] ? Best(s, wishes) : -1; g >= 0) {
          groups.size[g]++;
          layer.Append({s, g});
        }
      for (auto [s, g] : layer)
        Put(s, g);
    } while (layer.Size());
  }

private:
  void Put(int face, int g) {
    groups.of_face[face] = g;
    faces[g].Append(face);
  }
  /// The smallest group of a neighbour that suits; -1: none, or it has one.
  int Best(int face, const Wishes & wishes) const {
    int best = -1;
    if (groups.of_face[face] >= 0)
      return best;
    for (int t : tr.neighbours[face])
      if (int g = groups.of_face[t]; g >= 0 && Continues(face, t) && Suits(face, g, wishes) &&
                                     (best < 0 || groups.size[g] < groups.size[best]))
        best = g;
    return best;
  }
  bool Suits(int face, int g, const Wishes & wishes) const {
    if (wishes.small && groups.size[g] >= groups.limit[g])
      return false;
    if (wishes.reaches && !reach[g].Covers(tr.moves[face]))
      return false;
    return !wishes.flat || std::all_of(faces[g].begin(), faces[g].end(),
                                       [&](int other) { return Continues(face, other); });
  }
  /// Does one face not bend away from another?
  bool Continues(int face, int other) const {
    return InnerProduct(tr.normals[face], tr.normals[other]) > bend_cosine;
  }
};

/// All free dofs whose trace lives in one macro-element alone.
Array<Array<int>> CoreDofs(const Traces & tr, FlatArray<int> macro, size_t nmacros) {
  Array<Array<int>> cores(nmacros);
  for (size_t dof : Range(tr.dof_faces)) {
    auto faces = tr.dof_faces[dof];
    if (faces.Size() == 0 || !tr.inner_dofs.Test(dof))
      continue;
    bool inside = true;
    for (int s : faces)
      inside = inside && macro[s] == macro[faces[0]];
    if (inside)
      cores[macro[faces[0]]].Append(dof);
  }
  return cores;
}

MacroPartition Finish(const Traces & tr, FlatArray<int> macro, size_t nmacros) {
  MacroPartition partition;
  partition.nmacros = nmacros;
  partition.macro_of_face.SetSize(tr.slave_of_face.Size());
  partition.macro_of_face = -1;
  Array<Vec<3>> normals(nmacros);
  normals = Vec<3>(0.0);
  for (int s : Range(macro)) {
    partition.macro_of_face[tr.faces[s]] = macro[s];
    normals[macro[s]] += tr.normals[s];
  }
  partition.cores = CoreDofs(tr, macro, nmacros);
  partition.reach.SetSize(nmacros);
  for (size_t m : Range(nmacros)) {
    Reach reach = ReachOf(tr, partition.cores[m]);
    partition.reach[m] = 0.0;
    if (reach.Reaches((1 / L2Norm(normals[m])) * normals[m]))
      partition.reach[m] = tr.components == 1 ? Mat<3, 3>(Id<3>()) : reach.Projector();
  }
  return partition;
}

/// Throws unless the faces of a macro-element hang together and look the same way.
void CheckShape(const Traces & tr, FlatArray<int> macros, int macro, FlatArray<int> faces) {
  string which = "LACSpace: macros makes macro-element " + ToString(macro) + " of " +
                 ToString(faces.Size()) + " faces that ";
  Array<int> found{faces[0]};
  for (size_t i = 0; i < found.Size(); i++)
    for (int t : tr.neighbours[found[i]])
      if (macros[t] == macro && !found.Contains(t))
        found.Append(t);
  if (found.Size() < faces.Size())
    throw std::invalid_argument(which + "do not hang together; give each part its own number");
  if (Bends(tr, faces))
    throw std::invalid_argument(which + "bend by more than 60 degrees, so that no normal stands "
                                        "for all of them; make smaller macro-elements");
}

/// The faces of each macro-element that the caller gives.
Array<Array<int>> GivenFaces(FlatArray<int> macros, size_t nfaces) {
  if (macros.Size() != nfaces)
    throw std::invalid_argument("LACSpace: macros has " + ToString(macros.Size()) +
                                " entries, but there are " + ToString(nfaces) +
                                " slave faces; give one number per face");
  int highest = -1;
  for (int m : macros) {
    if (m < 0)
      throw std::invalid_argument("LACSpace: macros holds the negative number " + ToString(m) +
                                  "; number the macro-elements from 0");
    highest = max(highest, m);
  }
  if (highest >= int(nfaces)) // before anything is allocated
    throw std::invalid_argument("LACSpace: macros holds the number " + ToString(highest) +
                                ", but " + ToString(nfaces) + " slave faces make no more than " +
                                ToString(nfaces) + " macro-elements; number them densely from 0");
  Array<Array<int>> faces(highest + 1);
  for (int s : Range(macros))
    faces[macros[s]].Append(s);
  for (int m : Range(faces))
    if (faces[m].Size() == 0)
      throw std::invalid_argument("LACSpace: macros uses numbers up to " + ToString(highest) +
                                  ", but macro-element " + ToString(m) +
                                  " has no face; number them densely");
  return faces;
}
} // namespace

MacroPartition PartitionBySupports(const FESpace & displacement, const BitArray & boundaries) {
  static Timer timer("ngslac::PartitionBySupports");
  RegionTimer reg(timer);
  auto tr = CollectTraces(displacement, boundaries);
  size_t n = tr.faces.Size();
  Groups groups;
  groups.of_face.SetSize(n);
  groups.of_face = -1;
  Array<Reach> reach; // of each group
  auto candidates = FindCandidates(tr);
  for (int c : ChooseDisjoint(tr, candidates)) {
    auto support = Support(tr, candidates[c]);
    groups.Add(support, Limit(tr.dim, support.Size()));
    reach.Append(ReachOf(tr, candidates[c]));
  }
  Leftovers leftovers(tr, groups, reach);
  leftovers.JoinSmall({.small = true, .reaches = true});
  leftovers.JoinMovable({.reaches = true, .flat = true});
  leftovers.JoinMovable({.reaches = true});
  leftovers.JoinMovable({});
  BitArray alone(n); // faces that nothing moves
  alone.Clear();
  Array<int> lost;
  for (size_t s : Range(n)) {
    if (!tr.movable[s] && groups.size.Size())
      alone.SetBit(s);
    else if (groups.of_face[s] < 0)
      lost.Append(s);
  }
  if (lost.Size())
    ThrowUnstable(displacement, tr, lost);
  groups.AddFaces(alone);
  return Finish(tr, groups.Numbers(), groups.size.Size());
}

MacroPartition CheckedPartition(const FESpace & displacement, const BitArray & boundaries,
                                FlatArray<int> macros) {
  auto tr = CollectTraces(displacement, boundaries);
  auto faces = GivenFaces(macros, tr.faces.Size());
  for (size_t m : Range(faces))
    CheckShape(tr, macros, m, faces[m]);
  auto partition = Finish(tr, macros, faces.Size());
  bool any = std::any_of(tr.movable.begin(), tr.movable.end(), [](bool moves) { return moves; });
  for (size_t m : Range(faces)) {
    bool moves =
        std::any_of(faces[m].begin(), faces[m].end(), [&](int s) { return tr.movable[s]; });
    if ((moves || !any) && !Controls(tr, partition.cores[m], faces[m]))
      ThrowUnstable(displacement, tr, faces[m]);
  }
  return partition;
}
} // namespace ngslac
