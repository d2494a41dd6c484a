// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include "contactform.hpp"

namespace ngslac {
/// The states that `AppendState` has written; throws if that was not all.
Array<MacroState> StatesFrom(FlatArray<double> flat);

/// Throws unless that is the number of a status.
Status StatusFrom(double number);

template <int D>
void AppendVector(Array<double> & flat, const Vec<D> & vector) {
  for (int k : Range(D))
    flat.Append(vector(k));
}
/// Vectors as numbers, the space dimension fastest.
template <int D>
void SaveVectors(Array<double> & flat, FlatArray<Vec<D>> vectors) {
  for (auto & v : vectors)
    AppendVector<D>(flat, v);
}
template <int D>
void LoadVectors(FlatArray<double> flat, FlatArray<Vec<D>> vectors) {
  for (size_t i : Range(vectors))
    for (int k : Range(D))
      vectors[i](k) = flat[D * i + k];
}

/// What a contact form remembers, by name: its own numbers are written there, or read from there.
struct History {
  NamedNumbers & numbers;
  bool reads;

  void Exchange(const string & name, Array<double> & own) {
    if (reads)
      own = numbers.at(name);
    else
      numbers[name] = own;
  }
  void Exchange(const string & name, double & own) {
    Array<double> one{own};
    Exchange(name, one);
    own = one[0];
  }
  template <int D>
  void Exchange(const string & name, Array<Vec<D>> & own) {
    if (reads)
      LoadVectors<D>(numbers.at(name), own);
    else
      SaveVectors<D>(numbers[name], own);
  }
};
} // namespace ngslac
