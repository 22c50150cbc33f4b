// SPDX-License-Identifier: GPL-3.0-or-later
#include "grid/nrrd.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <limits>
#include <type_traits>

#include "base/error.h"
#include "base/memory_budget.h"
#include "base/write_file.h"
#include "grid/nrrd_header.h"

namespace trephine::grid {
namespace {

using detail::bytes_of;
using detail::NrrdHeader;
using detail::NrrdType;

static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__, "the raw encoding writes memory as it lies");

template <class T>
constexpr NrrdType type_for() {
  return std::is_same_v<T, std::int16_t> ? NrrdType::int16
         : std::is_same_v<T, float>      ? NrrdType::float32
                                         : NrrdType::uint8;
}

template <class T>
void write_grid(const std::filesystem::path& file, const Grid<T>& grid, const NrrdKeys& keys, NrrdEncoding encoding) {
  if (grid.voxels.size() != grid.count())
    throw Error(ExitCode::internal, file.string(), "sizes", "do not agree with the voxels");
  const std::string header = detail::nrrd_header_text(grid, type_for<T>(), encoding, keys);
  const std::string_view bytes(reinterpret_cast<const char*>(grid.voxels.data()), grid.voxels.size() * sizeof(T));
  FileWriter out(file);
  out.write(header);
  if (encoding == NrrdEncoding::gzip)
    out.write(detail::gzip_compress(bytes));
  else
    out.write(bytes);
  out.commit();
}

// The source of the bytes: a file, or memory.
class Input {
 public:
  virtual ~Input() = default;
  virtual std::uint64_t size() const = 0;
  /// The caller keeps offset + count within size().
  virtual void read(std::uint64_t offset, char* out, std::uint64_t count) const = 0;
};

class InputBytes : public Input {
 public:
  explicit InputBytes(std::string_view bytes) : bytes_(bytes) {}
  std::uint64_t size() const override { return bytes_.size(); }
  void read(std::uint64_t offset, char* out, std::uint64_t count) const override {
    if (count > 0) std::memcpy(out, bytes_.data() + offset, count);
  }

 private:
  std::string_view bytes_;
};

class InputFile : public Input {
 public:
  explicit InputFile(const std::filesystem::path& path) : name_(path.string()) {
    fd_ = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
    struct stat s {};
    if (fd_ < 0 || ::fstat(fd_, &s) != 0 || !S_ISREG(s.st_mode)) {
      const std::string why = fd_ < 0 ? std::strerror(errno) : "not a file";
      if (fd_ >= 0) ::close(fd_);
      throw Error(ExitCode::no_input, name_, "", why);
    }
    size_ = static_cast<std::uint64_t>(s.st_size);
  }
  ~InputFile() override { ::close(fd_); }
  InputFile(const InputFile&) = delete;
  InputFile& operator=(const InputFile&) = delete;
  std::uint64_t size() const override { return size_; }
  void read(std::uint64_t offset, char* out, std::uint64_t count) const override {
    while (count > 0) {
      const ssize_t n = ::pread(fd_, out, std::min<std::uint64_t>(count, 1 << 30), static_cast<off_t>(offset));
      if (n < 0 && errno == EINTR) continue;
      if (n <= 0)
        throw Error(ExitCode::io, name_, "", n < 0 ? std::strerror(errno) : "became shorter while it was read");
      out += n;
      offset += static_cast<std::uint64_t>(n);
      count -= static_cast<std::uint64_t>(n);
    }
  }

 private:
  std::string name_;
  int fd_ = -1;
  std::uint64_t size_ = 0;
};

// The header's text up to and with its empty line.
std::string read_header_text(const Input& in) {
  constexpr std::uint64_t limit = 1 << 20;
  std::string text;
  for (std::uint64_t piece = 4096; text.size() < std::min(limit, in.size()); piece *= 4) {
    const std::size_t have = text.size();
    text.resize(std::min({have + piece, limit, in.size()}));
    in.read(have, text.data() + have, text.size() - have);
    if (text.compare(0, 4, "NRRD", std::min<std::size_t>(4, text.size())) != 0)
      throw Error(ExitCode::bad_input, "", "header", "not a NRRD file");
    for (const char* end : {"\n\n", "\n\r\n"}) {
      const auto at = text.find(end);
      if (at != std::string::npos) return text.substr(0, at + std::strlen(end));
    }
  }
  throw Error(ExitCode::bad_input, "", "header", "has no end");
}

// What reading it, and working on it, will take at least: the samples, and a field of the same voxels.
void require_memory_for(const NrrdHeader& h) {
  const auto voxels = static_cast<std::uint64_t>(h.lattice.count());
  require_memory(voxels * (detail::bytes_of(h.type) + sizeof(float)),
                 "a volume of " + std::to_string(h.lattice.size[0]) + " x " + std::to_string(h.lattice.size[1]) +
                     " x " + std::to_string(h.lattice.size[2]) + " voxels");
}

template <class S>
std::vector<S> read_samples(const Input& in, std::uint64_t data_begin, const NrrdHeader& h, GzipLimit limit) {
  const std::uint64_t wanted = h.lattice.count() * sizeof(S), have = in.size() - data_begin;
  const auto disagree = [&] {
    throw Error(ExitCode::bad_input, "", "sizes",
                "need " + std::to_string(wanted) + " bytes, the file holds " + std::to_string(have));
  };
  std::vector<S> samples;
  if (!h.gzip) {
    if (wanted != have) disagree();
    require_memory_for(h);
    samples.resize(h.lattice.count());
    in.read(data_begin, reinterpret_cast<char*>(samples.data()), wanted);
  } else {
    // Deflate gains at most a factor of 1032. What claims to have gained much is counted before memory is taken for it.
    if (wanted / 1032 > have) disagree();
    if (wanted > limit.bytes(have))
      throw Error(ExitCode::bad_input, "", "data",
                  std::to_string(have) + " bytes would grow to " + std::to_string(wanted) + ", which no scan's do");
    std::string compressed(have, '\0');
    in.read(data_begin, compressed.data(), have);
    if (wanted > (std::uint64_t{64} << 20) && wanted / 100 > have) detail::gzip_expand(compressed, nullptr, wanted);
    require_memory_for(h);
    samples.resize(h.lattice.count());
    detail::gzip_expand(compressed, reinterpret_cast<char*>(samples.data()), wanted);
  }
  if (h.big_endian && sizeof(S) > 1)
    for (S& s : samples) {
      char* p = reinterpret_cast<char*>(&s);
      std::reverse(p, p + sizeof(S));
    }
  return samples;
}

template <class T>
Grid<T> to_grid(const Lattice& lattice, std::vector<T>&& voxels) {
  Grid<T> g;
  static_cast<Lattice&>(g) = lattice;
  g.voxels = std::move(voxels);
  return g;
}

template <class T, class S>
Grid<T> converted(const Lattice& lattice, const std::vector<S>& samples) {
  Grid<T> g;
  static_cast<Lattice&>(g) = lattice;
  g.voxels.assign(samples.begin(), samples.end());
  return g;
}

void check_finite(const std::vector<float>& voxels) {
  for (std::size_t i = 0; i < voxels.size(); ++i)
    if (!std::isfinite(voxels[i]))
      throw Error(ExitCode::bad_input, "", "data", "voxel " + std::to_string(i) + " is not finite");
}

// Makes a volume of int16 where every value fits, else of float32.
template <class S>
AnyGrid from_integers(const Lattice& lattice, const std::vector<S>& samples) {
  const auto [least, most] = std::minmax_element(samples.begin(), samples.end());
  using Limits = std::numeric_limits<std::int16_t>;
  if (std::int64_t{*least} >= Limits::min() && std::int64_t{*most} <= Limits::max())
    return converted<std::int16_t>(lattice, samples);
  return converted<float>(lattice, samples);
}

AnyGrid read_voxels(const Input& in, std::uint64_t at, const NrrdHeader& h, GzipLimit limit) {
  switch (h.type) {
    case NrrdType::int16:
      return to_grid(h.lattice, read_samples<std::int16_t>(in, at, h, limit));
    case NrrdType::uint8:
      return to_grid(h.lattice, read_samples<std::uint8_t>(in, at, h, limit));
    case NrrdType::float32: {
      auto g = to_grid(h.lattice, read_samples<float>(in, at, h, limit));
      check_finite(g.voxels);
      return g;
    }
    case NrrdType::float64: {
      auto g = converted<float>(h.lattice, read_samples<double>(in, at, h, limit));
      check_finite(g.voxels);
      return g;
    }
    case NrrdType::int8:
      return from_integers(h.lattice, read_samples<std::int8_t>(in, at, h, limit));
    case NrrdType::uint16:
      return from_integers(h.lattice, read_samples<std::uint16_t>(in, at, h, limit));
    case NrrdType::int32:
      return from_integers(h.lattice, read_samples<std::int32_t>(in, at, h, limit));
    case NrrdType::uint32:
      return from_integers(h.lattice, read_samples<std::uint32_t>(in, at, h, limit));
  }
  throw Error(ExitCode::internal, "", "type", "unknown");
}

template <class T>
std::string encode_grid(const Grid<T>& grid, const NrrdKeys& keys, NrrdEncoding encoding) {
  if (grid.voxels.size() != grid.count()) throw Error(ExitCode::internal, "", "sizes", "do not agree with the voxels");
  std::string out = detail::nrrd_header_text(grid, type_for<T>(), encoding, keys);
  const std::string_view bytes(reinterpret_cast<const char*>(grid.voxels.data()), grid.voxels.size() * sizeof(T));
  if (encoding == NrrdEncoding::gzip) return out + detail::gzip_compress(bytes);
  out.reserve(out.size() + bytes.size());
  return out.append(bytes);
}

Nrrd read_all(const Input& in, GzipLimit limit) {
  const std::string text = read_header_text(in);
  NrrdHeader h = detail::parse_nrrd_header(text);
  Nrrd out{read_voxels(in, text.size(), h, limit), std::move(h.keys)};
  if (!h.unknown.empty()) out.warnings.push_back(detail::told_unknown(h.unknown));
  return out;
}

}  // namespace

void write_nrrd(const std::filesystem::path& file, const HuVolume& volume, const NrrdKeys& keys,
                NrrdEncoding encoding) {
  std::visit([&](const auto& g) { write_grid(file, g, keys, encoding); }, volume);
}

void write_nrrd(const std::filesystem::path& file, const Field& field, const NrrdKeys& keys, NrrdEncoding encoding) {
  write_grid(file, field, keys, encoding);
}

void write_nrrd(const std::filesystem::path& file, const Mask& mask, const NrrdKeys& keys, NrrdEncoding encoding) {
  write_grid(file, mask, keys, encoding);
}

Nrrd read_nrrd(const std::filesystem::path& file, GzipLimit limit) {
  const InputFile in(file);
  return with_file(file.string(), [&] { return read_all(in, limit); });
}

std::string encode_nrrd(const HuVolume& volume, const NrrdKeys& keys, NrrdEncoding encoding) {
  return std::visit([&](const auto& g) { return encode_grid(g, keys, encoding); }, volume);
}

std::string encode_nrrd(const Mask& mask, const NrrdKeys& keys, NrrdEncoding encoding) {
  return encode_grid(mask, keys, encoding);
}

Nrrd decode_nrrd(std::string_view bytes, GzipLimit limit) { return read_all(InputBytes(bytes), limit); }

LayeredNrrd decode_layered_nrrd(std::string_view bytes) {
  const InputBytes in(bytes);
  const std::string text = read_header_text(in);
  NrrdHeader h = detail::parse_nrrd_header(text, true);
  LayeredNrrd out;
  out.lattice = h.lattice;
  out.layers = h.layers;
  h.lattice.size[0] *= h.layers;
  out.samples = read_voxels(in, text.size(), h, labels_limit);
  out.keys = std::move(h.keys);
  return out;
}

std::string encode_layered_nrrd(const LayeredNrrd& layered) {
  const Mask* samples = std::get_if<Mask>(&layered.samples);
  if (!samples || layered.layers < 1 || samples->voxels.size() != layered.lattice.count() * std::size_t(layered.layers))
    throw Error(ExitCode::internal, "", "sizes", "do not agree with the layers of labels");
  const std::string_view bytes(reinterpret_cast<const char*>(samples->voxels.data()), samples->voxels.size());
  return detail::nrrd_header_text(layered.lattice, NrrdType::uint8, NrrdEncoding::gzip, layered.keys, layered.layers) +
         detail::gzip_compress(bytes);
}

HuVolume to_hu(AnyGrid grid) {
  if (auto* g = std::get_if<Grid<std::int16_t>>(&grid)) return std::move(*g);
  if (auto* g = std::get_if<Grid<float>>(&grid)) return std::move(*g);
  const auto& m = std::get<Mask>(grid);
  return converted<std::int16_t>(m, m.voxels);
}

Field to_field(AnyGrid grid) {
  if (auto* g = std::get_if<Grid<float>>(&grid)) return std::move(*g);
  if (const auto* g = std::get_if<Grid<std::int16_t>>(&grid)) return converted<float>(*g, g->voxels);
  const auto& m = std::get<Mask>(grid);
  Field f(m);
  std::transform(m.voxels.begin(), m.voxels.end(), f.voxels.begin(), [](std::uint8_t v) { return v ? 0.5f : -0.5f; });
  return f;
}

HuVolume read_hu_nrrd(const std::filesystem::path& file) { return to_hu(read_nrrd(file).grid); }

Field read_field_nrrd(const std::filesystem::path& file) { return to_field(read_nrrd(file).grid); }

Mask read_mask_nrrd(const std::filesystem::path& file) {
  return with_file(file.string(), [&] { return to_mask(read_nrrd(file).grid); });
}

Mask to_mask(AnyGrid grid) {
  if (auto* g = std::get_if<Mask>(&grid)) return std::move(*g);
  return std::visit(
      [&](const auto& g) {
        for (const auto v : g.voxels)
          if (!(v >= 0 && v <= 255) || static_cast<decltype(v)>(static_cast<std::uint8_t>(v)) != v)
            throw Error(ExitCode::bad_input, "", "data", "a mask or labels must hold whole numbers from 0 to 255");
        return converted<std::uint8_t>(g, g.voxels);
      },
      grid);
}

}  // namespace trephine::grid
