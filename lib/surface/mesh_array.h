// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <utility>
#include <vector>

namespace trephine::meshing {
class ProofOfValidity;
}

namespace trephine::surface {

/// A vector that remembers whether it is unchanged since its mesh was proven valid (TriMesh::proven_valid). It carries
/// the number of that proof, and every function that can change an element or the size forgets it. Access through a
/// name that is not const forgets it too, even for reading: use a const reference where the proof must stay. A copy, or
/// the target of a move, holds the same elements and the same number; the source of a move holds none.
///
/// A reference to an element is invalidated by the proof, as an iterator would be: the array cannot know what is
/// written through a reference that is older than the proof. The next require_valid() finds it (Error 70), for the
/// number is a digest of what was proven. Different threads may write different elements, as with a vector.
template <class T>
class MeshArray {
 public:
  using value_type = T;
  using size_type = std::size_t;
  using reference = T&;
  using const_reference = const T&;
  using iterator = typename std::vector<T>::iterator;
  using const_iterator = typename std::vector<T>::const_iterator;

  MeshArray() = default;
  MeshArray(std::vector<T> items) : items_(std::move(items)) {}
  MeshArray(std::initializer_list<T> items) : items_(items) {}
  MeshArray(const MeshArray& other) : items_(other.items_), proof_(other.proof()) {}
  MeshArray(MeshArray&& other) noexcept : items_(std::move(other.items_)), proof_(other.proof_.exchange(0)) {}
  MeshArray& operator=(const MeshArray& other) {
    if (this == &other) return *this;
    forget();
    items_ = other.items_;
    proof_ = other.proof();
    return *this;
  }
  MeshArray& operator=(MeshArray&& other) noexcept {
    if (this == &other) return *this;
    items_ = std::move(other.items_);
    proof_ = other.proof_.exchange(0);
    return *this;
  }
  ~MeshArray() = default;

  operator const std::vector<T>&() const { return items_; }
  std::size_t size() const { return items_.size(); }
  bool empty() const { return items_.empty(); }
  const T& operator[](std::size_t i) const { return items_[i]; }
  const T& at(std::size_t i) const { return items_.at(i); }
  const T& front() const { return items_.front(); }
  const T& back() const { return items_.back(); }
  const T* data() const { return items_.data(); }
  const_iterator begin() const { return items_.begin(); }
  const_iterator end() const { return items_.end(); }
  friend bool operator==(const MeshArray& a, const MeshArray& b) { return a.items_ == b.items_; }
  friend bool operator!=(const MeshArray& a, const MeshArray& b) { return !(a == b); }

  T& operator[](std::size_t i) { return changing()[i]; }
  T& at(std::size_t i) { return changing().at(i); }
  T& front() { return changing().front(); }
  T& back() { return changing().back(); }
  T* data() { return changing().data(); }
  iterator begin() { return changing().begin(); }
  iterator end() { return changing().end(); }
  void reserve(std::size_t count) { items_.reserve(count); }
  void resize(std::size_t count) { changing().resize(count); }
  void clear() { changing().clear(); }
  void push_back(const T& item) { changing().push_back(item); }
  void pop_back() { changing().pop_back(); }
  template <class... Arguments>
  void assign(Arguments&&... arguments) {
    changing().assign(std::forward<Arguments>(arguments)...);
  }
  template <class... Arguments>
  iterator insert(Arguments&&... arguments) {
    return changing().insert(std::forward<Arguments>(arguments)...);
  }
  iterator insert(const_iterator where, std::initializer_list<T> items) { return changing().insert(where, items); }
  template <class... Arguments>
  iterator erase(Arguments&&... arguments) {
    return changing().erase(std::forward<Arguments>(arguments)...);
  }

  std::uint64_t proof() const { return proof_.load(std::memory_order_relaxed); }

 private:
  friend class meshing::ProofOfValidity;  // meshing/validity.cpp: it alone gives the number
  void forget() {
    // Threads that write elements at the same time only read here, once one of them has forgotten the proof.
    if (proof() != 0) proof_.store(0, std::memory_order_relaxed);
  }
  std::vector<T>& changing() {
    forget();
    return items_;
  }

  std::vector<T> items_;
  mutable std::atomic<std::uint64_t> proof_{0};  ///< 0: none
};

}  // namespace trephine::surface
