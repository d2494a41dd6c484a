// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include "pairing/pairing.hpp"
#include "space/lacspace.hpp"
#include <atomic>
#include <fem.hpp>

namespace ngslac {
/// One entry of a macro-element's row: the integral of a basis function over its paired part.
template <int D>
struct JumpEntry {
  int dof;
  Vec<D> integral; // slave minus master
};

/// Moment about the origin; in 2D only its last component is not 0.
inline Vec<3> Moment(const Vec<2> & x, const Vec<2> & force) {
  return {0, 0, x(0) * force(1) - x(1) * force(0)};
}
inline Vec<3> Moment(const Vec<3> & x, const Vec<3> & force) {
  return Cross(x, force);
}

enum class Side { slave = 1, master = 2, both = 3 };

/// Where the values of a proxy come from.
struct ProxyInfo {
  shared_ptr<FESpace> fes;                    // space of the proxy, maybe a product
  shared_ptr<FESpace> component;              // the component the proxy belongs to
  size_t offset;                              // of the component's dofs
  std::vector<int> path;                      // numbers of components, from the product down
  shared_ptr<DifferentialOperator> evaluator; // on the boundary

  ProxyInfo(const CoefficientFunction & proxy, const string & name);
  /// highest polynomial order on the faces of a surface
  template <int D>
  int Order(const Surface<D> & surface) const;
};

/// The macro-elements over a pairing: areas, normals, gaps and the operator  u -> int [u1 - u2].
template <int D>
class MacroJump {
public:
  /// The rows of the operator are left out until they are needed.
  MacroJump(const LACSpace & space, const Surface<D> & slave, const Pairing<D> & pairing);

  void SetRows(const ProxyInfo & u, const Surface<D> & slave, const Surface<D> * master,
               const Pairing<D> & pairing, Side side = Side::both);
  /// Others in their place, one array for each macro-element.
  void TakeRows(FlatArray<Array<JumpEntry<D>>> rows);
  /// means of x1 - x2 in the configuration of the pairing
  Array<Vec<D>> GapVectors(const Pairing<D> & pairing) const;
  /// means of both normals over the paired part, 0 without one
  Array<Vec<D>> SlaveNormals(const Pairing<D> & pairing) const;
  Array<Vec<D>> MasterNormals(const Surface<D> & master, const Pairing<D> & pairing) const;
  bool HasRows() const { return first.Size() > 0; }
  size_t Size() const { return area.Size(); }
  /// Empty without a partner.
  FlatArray<JumpEntry<D>> Row(size_t macro) const {
    return entries.Range(first[macro], area[macro] > 0 ? first[macro + 1] : first[macro]);
  }
  /// Factor of a multiplier's rows: the paired area, and where there is none that of all faces.
  double RowArea(size_t macro) const { return area[macro] > 0 ? area[macro] : fullarea[macro]; }
  /// A length: how large a macro-element is.
  double Size(size_t macro) const { return pow(fullarea[macro] / way[macro], 1.0 / (D - 1)); }
  /// mean of u1 - u2 over the paired part
  Vec<D> Mean(size_t macro, FlatVector<> x) const;
  /// How the rows give way where each dof has a spring of its own, a mean over the components.
  double Compliance(size_t macro, FlatVector<> diagonal) const;
  /// The rows of the first components, times a factor; of the columns those of a part of the
  /// product space that begins at `offset`.
  shared_ptr<SparseMatrix<double>> AsMatrix(size_t offset, size_t width, int components,
                                            double factor) const;

  Array<double> area;     // paired
  Array<double> fullarea; // of all faces
  Array<double> way;      // how far each turns in a body of revolution, else 1
  Array<Vec<D>> normal;   // unit, mean of the outward slave normals
  Array<double> flatness; // length of that mean: 1 where the macro-element is plane
  Array<Vec<D>> center;   // of all faces
  Array<Vec<D>> moment;   // integral of x over the paired part

  /// No other rows have this number.
  size_t Number() const { return number; }

private:
  static size_t NextNumber() {
    static std::atomic<size_t> last = 0;
    return ++last;
  }
  /// Means over the paired part of a function of the master face and the point.
  template <typename F>
  Array<Vec<D>> Means(const Pairing<D> & pairing, F value) const;
  void Geometry(size_t macro, const Surface<D> & slave, const Pairing<D> & pairing);

  Table<int> faces;         // of the macro-elements
  Array<int> first_segment; // of the slave faces, and one more
  Array<size_t> first;
  Array<JumpEntry<D>> entries;
  size_t number = NextNumber();
};
} // namespace ngslac
