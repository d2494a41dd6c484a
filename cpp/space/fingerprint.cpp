// SPDX-License-Identifier: LGPL-2.1-or-later
#include "fingerprint.hpp"

namespace ngslac {
namespace {
/// The hash of Fowler, Noll and Vo, over numbers in place of bytes.
class Hash {
public:
  void Add(size_t number) { value = (value ^ number) * 1099511628211u; }
  size_t Value() const { return value; }

private:
  size_t value = 14695981039346656037u;
};
} // namespace

size_t DofFingerprint(const FESpace & space) {
  Hash hash;
  hash.Add(space.GetNDof());
  hash.Add(space.GetDimension());
  Array<DofId> dofs;
  for (auto vb : {VOL, BND})
    for (auto element : space.GetMeshAccess()->Elements(vb)) {
      space.GetDofNrs(element, dofs);
      hash.Add(dofs.Size());
      for (auto dof : dofs)
        hash.Add(size_t(dof));
    }
  return hash.Value();
}
} // namespace ngslac
