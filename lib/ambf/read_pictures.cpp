// SPDX-License-Identifier: GPL-3.0-or-later
#include "ambf/read_pictures.h"

#include <png.h>

#include <algorithm>

#include "base/child.h"
#include "base/child_message.h"
#include "base/error.h"
#include "base/write_file.h"

namespace trephine::ambf {
namespace {

constexpr const char* worker_name = "png-read";
constexpr std::uint64_t at_once_bytes = std::uint64_t{64} << 20, largest_file_bytes = std::uint64_t{256} << 20;

void decode(const std::string& name, std::uint64_t width, std::uint64_t height, std::vector<std::uint8_t>& pixels) {
  const std::vector<char> bytes = read_file(name, largest_file_bytes);
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  const auto refuse = [&](const std::string& what) {
    png_image_free(&image);
    throw Error(ExitCode::bad_input, name, "", what);
  };
  if (!png_image_begin_read_from_memory(&image, bytes.data(), bytes.size())) refuse("is no PNG that can be read");
  if (image.width != width || image.height != height)
    refuse("has " + std::to_string(image.width) + " x " + std::to_string(image.height) +
           " pixels; the case's haptic volume has " + std::to_string(width) + " x " + std::to_string(height));
  image.format = PNG_FORMAT_RGBA;
  if (!png_image_finish_read(&image, nullptr, pixels.data(), 0, nullptr)) refuse("is damaged");
}

const ChildWorker png_worker(worker_name, [](ChildRequest& r) {
  MessageReader message(worker_name, r.request());
  const std::uint64_t width = message.number(), height = message.number(), count = message.number();
  std::vector<std::uint8_t> pixels(width * height * 4);
  for (std::uint64_t n = 0; n < count; ++n) {
    decode(std::string(message.text()), width, height, pixels);
    r.write(pixels.data(), pixels.size());
    r.report(double(n + 1) / double(count));
  }
});

}  // namespace

void read_pictures(const std::vector<std::filesystem::path>& files, int width, int height,
                   const std::function<void(std::size_t file, const std::uint8_t* pixels)>& take,
                   const Progress& progress) {
  const std::uint64_t each = std::uint64_t(width) * std::uint64_t(height) * 4;
  const auto at_once = std::size_t(std::max<std::uint64_t>(1, at_once_bytes / each));
  for (std::size_t from = 0; from < files.size(); from += at_once) {
    const std::size_t to = std::min(files.size(), from + at_once);
    MessageWriter request;
    request.number(std::uint64_t(width));
    request.number(std::uint64_t(height));
    request.number(to - from);
    for (std::size_t n = from; n < to; ++n) request.text(files[n].string());
    ChildLimits limits;
    limits.memory_bytes = std::uint64_t{1} << 30;
    limits.cpu_s = limits.wall_s = 120;
    const ChildResult result =
        run_child(worker_name, request.bytes(), limits,
                  progress.part(double(from) / double(files.size()), double(to) / double(files.size())));
    if (result.bytes().size() != each * (to - from))
      throw Error(ExitCode::internal, "", worker_name, "a message of the child is damaged");
    const auto* pixels = reinterpret_cast<const std::uint8_t*>(result.bytes().data());
    for (std::size_t n = from; n < to; ++n, pixels += each) take(n, pixels);
  }
}

}  // namespace trephine::ambf
