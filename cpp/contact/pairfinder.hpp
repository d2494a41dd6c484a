// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include "toolpath.hpp"

namespace ngslac {
/// The difference between the gap of the contact and that between the surfaces, by which the search
/// for openings and overlaps reaches farther.
struct SearchMargin {
  double farther = 0, deeper = 0;
  bool operator==(const SearchMargin & other) const {
    return farther == other.farther && deeper == other.deeper;
  }
};

/// Both surfaces in one configuration, cut into segments, and the macro-elements over them.
template <int D>
struct Paired {
  shared_ptr<Surface<D>> slave, master; // no master: an obstacle or a tool
  shared_ptr<Pairing<D>> pairing;
  shared_ptr<MacroJump<D>> jump = nullptr;          // null: not made yet
  SearchMargin margin = SearchMargin();             // of the search
  BitArray closed = BitArray();                     // macro-elements then, for self-contact
  Array<ToolDof<D>> unknowns = Array<ToolDof<D>>(); // how those of a tool move it there
};

/// How to treat a slave and a master that do not meet.
enum class Meeting {
  now,  // they are the wrong ones, or in the wrong place
  later // bodies may be apart, or come off each other
};

/// Makes the surfaces of a contact, and pairs them.
template <int D>
class PairFinder {
  ContactSetup setup;
  shared_ptr<LACSpace> space;
  ProxyInfo u;
  bool selfcontact;

public:
  PairFinder(const ContactSetup & asetup, shared_ptr<LACSpace> aspace, const ProxyInfo & au);

  /// Is one surface slave and master?
  bool IsSelfContact() const { return selfcontact; }
  /// The surfaces in a configuration, of the order of the displacement where that matters; null
  /// displacement: the reference one.
  unique_ptr<Surface<D>> Slave(shared_ptr<CoefficientFunction> displacement) const;
  unique_ptr<Surface<D>> Master(shared_ptr<CoefficientFunction> displacement) const;
  /// Throws where the surfaces have to meet but never do, and where nothing pairs as all lies too
  /// deep.
  Paired<D> Pair(unique_ptr<Surface<D>> slave, unique_ptr<Surface<D>> master, SearchMargin margin,
                 Meeting meeting = Meeting::now) const;
  /// Some faces of the slave once more, with more points.
  Pairing<D> PairFiner(const Surface<D> & slave, const Surface<D> & master, SearchMargin margin,
                       const BitArray & faces) const;
  /// How deep the search sees from the faces of each macro-element, at least.
  Array<double> Depths(const Surface<D> & slave, const Surface<D> & master) const;
  /// How deep the macro-elements of some faces lie in the master's body where that is too deep for
  /// the search; else 0.
  Array<double> Overlaps(const Surface<D> & slave, const Surface<D> * master, SearchMargin margin,
                         const BitArray & faces) const;

private:
  unique_ptr<Surface<D>> SurfaceOf(const Region & region,
                                   shared_ptr<CoefficientFunction> displacement) const;
  /// Degree of the functions that are integrated over a slave face.
  int Degree(const Surface<D> & slave, int order) const { return order + 2 * (slave.Degree() - 1); }
  PairingOptions Options(const Surface<D> & slave, const Surface<D> & master, int order,
                         SearchMargin margin) const;
  /// One surface is slave and master.
  void LimitToOthers(const Surface<D> & slave, const Surface<D> & master,
                     PairingOptions & options) const;
  /// Throws unless it may be that nothing pairs.
  void CheckMeeting(const Surface<D> & slave, const Surface<D> & master,
                    const PairingOptions & options, SearchMargin margin, Meeting meeting) const;
  /// Does maxdist alone keep them from pairing, so that they may meet later?
  bool AreApart(const Surface<D> & slave, const Surface<D> & master) const;
  /// Of each slave face, by how much it is too deep in the master's body, see Overlaps.
  Array<double> Excesses(const Surface<D> & slave, const Surface<D> & master,
                         const PairingOptions & options, const BitArray & faces) const;
};
} // namespace ngslac
