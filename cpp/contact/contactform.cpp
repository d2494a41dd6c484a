// SPDX-License-Identifier: LGPL-2.1-or-later
#include "contactform.hpp"

namespace ngslac {
ContactForm::ContactForm(const ContactSetup & asetup)
    : setup(asetup), u(*asetup.u, "u"), lam(*asetup.lam, "lam") {
  space = dynamic_pointer_cast<LACSpace>(lam.component);
  if (!space)
    throw Exception("LACContact: lam must belong to a LACSpace, not to " +
                    lam.component->GetClassName());
  if (u.fes != lam.fes)
    throw Exception("LACContact: u and lam belong to different product spaces");
  if (space->Displacement()->GetNDof() != u.component->GetNDof() ||
      space->Displacement()->GetClassName() != u.component->GetClassName())
    throw Exception("LACContact: lam was made for another displacement space (" +
                    space->Displacement()->GetClassName() + ") than that of u (" +
                    u.component->GetClassName() + "); its macro-elements may be unstable");
  if (setup.master && setup.master->Mesh() != u.fes->GetMeshAccess())
    throw Exception("LACContact: master is a region of another mesh than that of u");
  int dim = u.fes->GetMeshAccess()->GetDimension(), components = u.evaluator->Dim();
  if (components != dim && components != 1)
    throw Exception("LACContact: u needs " + ToString(dim) + " components, or 1 of what is tied");
  if (lam.evaluator->Dim() != components)
    throw Exception("LACContact: lam needs as many components as u, " + ToString(components) +
                    " (LACSpace without components=...)");
}

void ContactForm::CheckPaired() const {
  if (!IsPaired())
    throw Exception("LACContact: no pairing yet; call Update() first, or solve: forces, pressures "
                    "and tables are those of a solution");
  if (!IsCurrent())
    throw Exception("LACContact: the pairing is that of another mesh or space; after a refinement "
                    "call Update() of the space and of the contact, and make a new solver");
}
} // namespace ngslac
