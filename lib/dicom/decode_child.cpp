// SPDX-License-Identifier: GPL-3.0-or-later
// Runs GDCM's codecs in the bounded child process, on fragments and shapes that the parent process has checked.
#include <system_error>

#include "base/child.h"
#include "base/child_message.h"
#include "base/error.h"
#include "codecs/codecs.h"
#include "dicom/decode.h"

namespace trephine::dicom {
namespace {

constexpr const char* worker_name = "dicom-decode";

// The request: for each frame its shape and either its file and where the fragments lie in it, or, of an archive's
// member, the stream itself; as 8-byte numbers and texts with their length.
struct Job {
  std::string name, syntax, file, folder;
  int columns = 0, rows = 0, bits_allocated = 0, bits_stored = 0;
  bool is_signed = false;
  std::vector<Fragment> fragments;
  std::string stream;  ///< where file is empty
};

void pack(const FrameRef& ref, MessageWriter& p) {
  const FileHeader& h = *ref.header;
  p.text(h.name);
  p.text(h.syntax->uid);
  for (const int v : {h.columns, h.rows, h.bits_allocated, h.bits_stored, int{h.is_signed}})
    p.number(static_cast<std::uint64_t>(v));
  const auto [from, to] = h.frame_fragments[static_cast<std::size_t>(ref.frame)];
  if (h.origin.in_memory) {
    p.text("");
    p.text(stream_of_frame(ref));
    return;
  }
  p.text(std::filesystem::absolute(h.origin.file).string());
  p.text(h.origin.folder.empty() ? "" : std::filesystem::absolute(h.origin.folder).string());
  p.number(to - from);
  for (std::size_t i = from; i < to; ++i) {
    p.number(h.fragments[i].offset);
    p.number(h.fragments[i].length);
  }
}

Job unpack(MessageReader& u) {
  Job j;
  j.name = std::string(u.text());
  j.syntax = std::string(u.text());
  j.columns = static_cast<int>(u.number());
  j.rows = static_cast<int>(u.number());
  j.bits_allocated = static_cast<int>(u.number());
  j.bits_stored = static_cast<int>(u.number());
  j.is_signed = u.number() != 0;
  j.file = std::string(u.text());
  if (j.file.empty()) {
    j.stream = std::string(u.text());
    return j;
  }
  j.folder = std::string(u.text());
  for (std::uint64_t n = u.number(); n > 0; --n) {
    Fragment f;
    f.offset = u.number();
    f.length = static_cast<std::uint32_t>(u.number());
    j.fragments.push_back(f);
  }
  return j;
}

[[noreturn]] void bad_stream(const Job& j, const std::string& what) {
  throw Error(ExitCode::bad_input, j.name, tag_name(make_tag(0x7fe0, 0x0010)),
              std::string(find_transfer_syntax(j.syntax)->name) + ": " + what);
}

std::string read_stream(Job& j) {
  if (j.file.empty()) return std::move(j.stream);
  std::string stream;
  try {
    const ByteSource source{Origin::beneath(j.folder, j.file)};
    for (const Fragment& f : j.fragments) {
      const std::size_t at = stream.size();
      if (f.offset > source.size() || f.length > source.size() - f.offset) bad_stream(j, "the file shrank meanwhile");
      stream.resize(at + f.length);
      if (!source.read(f.offset, stream.data() + at, f.length)) bad_stream(j, "the file shrank meanwhile");
    }
  } catch (const std::system_error&) {
    throw Error(ExitCode::io, j.name, "", "cannot be read any more");
  }
  return stream;
}

std::vector<char> decode(Job& j) {
  const std::string stream = read_stream(j);
  const TransferSyntax& syntax = *find_transfer_syntax(j.syntax);
  if (stream.size() > 0xfffffffe) bad_stream(j, "larger than 4 GiB");
  const std::string fault = codecs::check_codestream(syntax.encoding, stream, j.columns, j.rows, j.bits_allocated);
  if (!fault.empty()) bad_stream(j, fault);

  std::vector<char> out;
  const codecs::CodedFrame frame{j.syntax, j.columns, j.rows, j.bits_allocated, j.bits_stored, j.is_signed};
  std::string undecoded;
  if (!codecs::codecs().decode(&frame, stream, &out, &undecoded)) bad_stream(j, undecoded);
  return out;
}

const ChildWorker worker(worker_name, [](ChildRequest& request) {
  MessageReader in(worker_name, request.request());
  const std::uint64_t count = in.number();
  for (std::uint64_t i = 0; i < count; ++i) {
    request.report(static_cast<double>(i) / static_cast<double>(count));
    Job job = unpack(in);
    const std::vector<char> out = decode(job);
    request.write(out.data(), out.size());
  }
});

ChildResult run(const std::vector<FrameRef>& frames, const Progress& progress) {
  MessageWriter request;
  request.number(frames.size());
  std::uint64_t bytes = 0, largest = 0;
  for (const FrameRef& f : frames) {
    pack(f, request);
    bytes += f.header->frame_bytes();
    largest = std::max(largest, f.header->frame_bytes());
  }
  ChildLimits limits;
  // The address space holds this program's libraries, one frame in each of its forms (stream, fragments, codec, output)
  // and the result.
  limits.memory_bytes = (std::uint64_t{2} << 30) + bytes + 16 * largest;
  limits.cpu_s = 30 + static_cast<double>(bytes) / 1e6;
  limits.wall_s = 2 * limits.cpu_s;
  return run_child(worker_name, request.bytes(), limits, progress);
}

}  // namespace

void decode_in_child(const std::vector<FrameRef>& frames, const FrameSink& sink, const Progress& progress) {
  ChildResult result;
  try {
    result = run(frames, progress);
  } catch (Error& e) {
    if (e.code() != ExitCode::internal) throw;
    // The child process died. Decoding the files one by one shows which of them caused it; if each of them decodes
    // alone, none did.
    for (const FrameRef& f : frames) {
      try {
        run({f}, progress);
      } catch (const Error& alone) {
        if (alone.code() != ExitCode::internal) throw;
        throw Error(ExitCode::internal, f.header->name, tag_name(f.header->pixels.tag),
                    std::string(f.header->syntax->name) + ": decoding failed: " + alone.what());
      }
    }
    throw;
  }
  std::uint64_t wanted = 0;
  for (const FrameRef& f : frames) wanted += f.header->frame_bytes();
  if (result.bytes().size() != wanted)
    throw Error(ExitCode::internal, "", worker_name, "the child gave another number of bytes");
  const auto* at = reinterpret_cast<const std::uint8_t*>(result.bytes().data());
  for (std::size_t i = 0; i < frames.size(); ++i) {
    sink(i, at);
    at += frames[i].header->frame_bytes();
  }
}

}  // namespace trephine::dicom
