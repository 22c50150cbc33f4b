// SPDX-License-Identifier: GPL-3.0-or-later
// The only file that includes libzip, and only the bounded child calls it.
#include "dicom/archive.h"

#include <fmt/format.h>
#include <sys/stat.h>
#include <sys/sysinfo.h>
#include <zip.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <memory>

#include "base/child_message.h"
#include "base/error.h"
#include "dicom/elements.h"

namespace trephine::dicom {
namespace {

constexpr const char* worker_name = "dicom-archive";

[[noreturn]] void refuse(const std::string& what) { throw Error(ExitCode::bad_input, "", "archive", what); }

struct CloseArchive {
  void operator()(zip_t* z) const { zip_discard(z); }
};
struct CloseMember {
  void operator()(zip_file_t* f) const { zip_fclose(f); }
};

/// Whether the bytes look like DICOM to read_header: they begin with group 8 or 2 in little endian, or with the
/// preamble.
bool begins_as_dicom(std::string_view head) {
  if (head.size() >= 132 && head.substr(128, 4) == "DICM") return true;
  return head.size() >= 8 && (head[0] == 8 || head[0] == 2) && head[1] == 0;
}

struct Name {
  std::string text;
  bool folder = false, hidden = false, leads_out = false;
};

Name name_of(const char* raw) {
  Name n;
  n.text = raw;
  std::replace(n.text.begin(), n.text.end(), '\\', '/');
  n.folder = n.text.empty() || n.text.back() == '/';
  n.leads_out = !n.text.empty() && (n.text[0] == '/' || (n.text.size() >= 2 && n.text[1] == ':'));
  for (std::size_t at = 0; at <= n.text.size();) {
    const std::size_t next = std::min(n.text.find('/', at), n.text.size());
    const std::string part = n.text.substr(at, next - at);
    if (part == "..") n.leads_out = true;
    if (part.size() > 1 && part[0] == '.') n.hidden = true;
    at = next + 1;
  }
  return n;
}

bool is_link(zip_t* z, zip_uint64_t i) {
  zip_uint8_t system = 0;
  zip_uint32_t attributes = 0;
  if (zip_file_get_external_attributes(z, i, 0, &system, &attributes) != 0) return false;
  return system == ZIP_OPSYS_UNIX && S_ISLNK(static_cast<mode_t>(attributes >> 16));
}

// What the child does: members in the archive's order as kind, name, bytes.
enum class Kind : std::uint64_t { member, hidden, link };
// Of a member of another kind: a slice that has lost its beginning still names its series.
constexpr std::size_t long_head = 16 << 10, short_head = 256, max_of_heads = 64 << 20;

class Unzipper {
 public:
  Unzipper(ChildRequest& request, std::string file, const ArchiveLimits& limits, std::vector<std::string> whole)
      : request_(request), file_(std::move(file)), limits_(limits), whole_(std::move(whole)) {}

  void run() {
    struct stat st {};
    if (::stat(file_.c_str(), &st) != 0) throw Error(ExitCode::io, "", "archive", "cannot be read any more");
    archive_bytes_ = static_cast<std::uint64_t>(st.st_size);
    int error = 0;
    const std::unique_ptr<zip_t, CloseArchive> zip(zip_open(file_.c_str(), ZIP_RDONLY, &error));
    if (!zip) {
      if (error == ZIP_ER_OPEN || error == ZIP_ER_READ) throw Error(ExitCode::io, "", "archive", "cannot be read");
      refuse("not a whole ZIP archive: cut short or damaged");
    }
    const auto count = static_cast<std::uint64_t>(std::max<zip_int64_t>(0, zip_get_num_entries(zip.get(), 0)));
    if (count > limits_.members) refuse(fmt::format("{} members, at most {} are read", count, limits_.members));
    // Everything that the directory shows is reported before anything is inflated.
    for (std::uint64_t i = 0; i < count; ++i) check(stat(zip.get(), i));
    for (std::uint64_t i = 0; i < count; ++i) {
      request_.report(static_cast<double>(i) / static_cast<double>(count));
      take(zip.get(), i);
    }
  }

 private:
  zip_stat_t stat(zip_t* zip, std::uint64_t i) {
    zip_stat_t s;
    constexpr zip_uint64_t needed =
        ZIP_STAT_NAME | ZIP_STAT_SIZE | ZIP_STAT_COMP_SIZE | ZIP_STAT_COMP_METHOD | ZIP_STAT_ENCRYPTION_METHOD;
    if (zip_stat_index(zip, i, 0, &s) != 0 || (s.valid & needed) != needed) refuse("its directory is damaged");
    return s;
  }

  void check(const zip_stat_t& s) {
    if (s.encryption_method != ZIP_EM_NONE) refuse("is encrypted: decrypt it first");
    if (name_of(s.name).leads_out) refuse("a member's name leads out of the archive");
  }

  void take(zip_t* zip, std::uint64_t i) {
    const zip_stat_t s = stat(zip, i);
    const Name name = name_of(s.name);
    if (name.folder) return;
    if (name.hidden) return put(Kind::hidden, "", 0);
    if (is_link(zip, i)) return put(Kind::link, "", 0);
    const std::unique_ptr<zip_file_t, CloseMember> member(zip_fopen_index(zip, i, 0));
    if (!member) {
      if (zip_error_code_zip(zip_get_error(zip)) == ZIP_ER_COMPNOTSUPP)
        refuse(fmt::format("compression method {} is not supported", s.comp_method));
      refuse("a member is damaged");
    }
    std::array<char, 1 << 18> buffer{};
    std::size_t have = read(member.get(), buffer.data(), std::min<std::uint64_t>(buffer.size(), s.size));
    if (!begins_as_dicom({buffer.data(), have}) && !is_taken_whole(name.text)) {
      const std::size_t head = std::min(have, heads_ < max_of_heads ? long_head : short_head);
      heads_ += head;
      put(Kind::member, name.text, head);
      request_.write(buffer.data(), head);
      return check_foreign(member.get(), s, have);
    }
    if (s.size > limits_.member_bytes)
      refuse(fmt::format("a member of {} bytes, at most {} are read", s.size, limits_.member_bytes));
    taken_ += s.size;
    if (taken_ > limits_.bytes) refuse(fmt::format("holds more than {} bytes of images: unpack it", limits_.bytes));
    if (taken_ > limits_.free_of_ratio && taken_ / limits_.ratio > archive_bytes_)
      refuse(fmt::format("expands to more than {} times its size", limits_.ratio));
    put(Kind::member, name.text, s.size);
    for (std::uint64_t left = s.size; left > 0;) {
      if (have == 0) refuse("a member is damaged: it ends before its size");
      request_.write(buffer.data(), have);
      left -= have;
      have = read(member.get(), buffer.data(), std::min<std::uint64_t>(buffer.size(), left));
    }
    // libzip compares the checksum at the member's end. A byte more would mean that the stated size is wrong.
    if (read(member.get(), buffer.data(), 1) != 0) refuse("a member is damaged: longer than its size");
  }

  bool is_taken_whole(const std::string& name) const {
    return std::any_of(whole_.begin(), whole_.end(), [&](const std::string& end) {
      return name.size() >= end.size() && name.compare(name.size() - end.size(), end.size(), end) == 0;
    });
  }

  /// Damage must not make a slice look like a file of another kind, so that it is left out silently. Therefore a member
  /// that is about as large as a slice is inflated to its end, where the checksum is compared.
  void check_foreign(zip_file_t* member, const zip_stat_t& s, std::uint64_t have) {
    constexpr std::uint64_t most = 64 << 20, max_of_all = std::uint64_t{2} << 30;
    if (s.size > most || s.size / limits_.ratio > s.comp_size || checked_ > max_of_all) return;
    checked_ += s.size;
    std::array<char, 1 << 16> buffer{};
    while (const std::size_t n = read(member, buffer.data(), buffer.size())) have += n;
    if (have != s.size) refuse("a member is damaged: its size is wrong");
  }

  std::size_t read(zip_file_t* member, char* to, std::uint64_t count) {
    std::size_t have = 0;
    do {
      const zip_int64_t n = zip_fread(member, to + have, count - have);
      if (n < 0) refuse("a member is damaged: its checksum or its compressed data is wrong");
      if (n == 0) break;
      have += static_cast<std::size_t>(n);
    } while (have < count);
    return have;
  }

  void put(Kind kind, const std::string& name, std::uint64_t size) {
    MessageWriter p;
    p.number(static_cast<std::uint64_t>(kind));
    p.text(name);
    p.number(size);
    request_.write(p.bytes());
  }

  ChildRequest& request_;
  const std::string file_;
  const ArchiveLimits limits_;
  const std::vector<std::string> whole_;
  std::uint64_t archive_bytes_ = 0, taken_ = 0, checked_ = 0, heads_ = 0;
};

const ChildWorker worker(worker_name, [](ChildRequest& request) {
  MessageReader in(worker_name, request.request());
  const std::string file(in.text());
  ArchiveLimits limits;
  for (std::uint64_t* v : {&limits.members, &limits.member_bytes, &limits.bytes, &limits.ratio, &limits.free_of_ratio})
    *v = in.number();
  std::vector<std::string> whole;
  while (!in.empty()) whole.emplace_back(in.text());
  Unzipper(request, file, limits, std::move(whole)).run();
});

}  // namespace

bool is_zip(const std::filesystem::path& file) {
  try {
    ByteSource source(file);
    const std::uint8_t* p = source.get(0, 4);
    return p && std::memcmp(p, "PK", 2) == 0 &&
           (std::memcmp(p + 2, "\3\4", 2) == 0 || std::memcmp(p + 2, "\5\6", 2) == 0);
  } catch (const std::system_error&) {
    return false;
  }
}

Archive read_archive(const std::filesystem::path& file, const Progress& progress, const ArchiveLimits& given,
                     const std::vector<std::string>& whole) {
  ArchiveLimits limits = given;
  struct sysinfo memory {};
  if (::sysinfo(&memory) == 0)  // what is taken lies in memory, beside the volume made of it
    limits.bytes = std::min<std::uint64_t>(limits.bytes, std::uint64_t{memory.totalram} * memory.mem_unit / 2);
  MessageWriter request;
  request.text(std::filesystem::absolute(file).string());
  for (const std::uint64_t v : {limits.members, limits.member_bytes, limits.bytes, limits.ratio, limits.free_of_ratio})
    request.number(v);
  for (const std::string& name : whole) request.text(name);
  ChildLimits bounds;
  bounds.memory_bytes = (std::uint64_t{2} << 30) + limits.bytes;
  bounds.cpu_s = 60 + static_cast<double>(limits.bytes) / 20e6;
  bounds.wall_s = 2 * bounds.cpu_s;

  Archive archive;
  archive.memory = run_child(worker_name, request.bytes(), bounds, progress);
  MessageReader in(worker_name, archive.memory.bytes());
  while (!in.empty()) {
    const auto kind = static_cast<Kind>(in.number());
    Archive::Member m;
    m.name = std::string(in.text());
    m.bytes = in.take(in.number());
    if (kind == Kind::hidden)
      ++archive.hidden;
    else if (kind == Kind::link)
      ++archive.links;
    else
      archive.members.push_back(std::move(m));
  }
  std::stable_sort(archive.members.begin(), archive.members.end(),
                   [](const Archive::Member& a, const Archive::Member& b) { return a.name < b.name; });
  return archive;
}

}  // namespace trephine::dicom
