// SPDX-License-Identifier: GPL-3.0-or-later
#include "library/sheet.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>

#include "base/error.h"
#include "base/parallel.h"
#include "base/png.h"
#include "base/text.h"
#include "base/write_file.h"
#include "page/html.h"
#include "page/page_notes.h"
#include "page/web_files.h"
#include "picture/image.h"

namespace trephine::library {
namespace fs = std::filesystem;
namespace {

constexpr const char *picture_name = "contact_sheet.png", *index_name = "index.html";
constexpr double max_pixels = 4e7;  // of the whole picture: with many cases the thumbnails become smaller
constexpr int max_side_px = 240, min_side_px = 40, columns_count = 5, max_png_bytes = 1 << 26;

// Scales the image into a box. Each new pixel is the mean of the pixels that it covers.
picture::Image scaled(const picture::Image& image, int width, int height) {
  picture::Image out(width, height, {1, 1, 1});
  if (image.width < 1 || image.height < 1) return out;
  const double scale = std::max(static_cast<double>(image.width) / width, static_cast<double>(image.height) / height);
  const int w = std::clamp(static_cast<int>(image.width / scale), 1, width),
            h = std::clamp(static_cast<int>(image.height / scale), 1, height);
  for (int y = 0; y < h; ++y)
    for (int x = 0; x < w; ++x) {
      const int x0 = static_cast<int>(x * scale), y0 = static_cast<int>(y * scale);
      const int x1 = std::min(image.width, std::max(x0 + 1, static_cast<int>((x + 1) * scale)));
      const int y1 = std::min(image.height, std::max(y0 + 1, static_cast<int>((y + 1) * scale)));
      long sum[3] = {0, 0, 0};
      for (int v = y0; v < y1; ++v)
        for (int u = x0; u < x1; ++u)
          for (int c = 0; c < 3; ++c) sum[c] += image.at(u, v)[c];
      const long n = long(x1 - x0) * (y1 - y0);
      for (int c = 0; c < 3; ++c)
        out.at(x + (width - w) / 2, y + (height - h) / 2)[c] =
            static_cast<std::uint8_t>((sum[c] + n / 2) / std::max(n, 1L));
    }
  return out;
}

void paste(const picture::Image& from, picture::Image& to, int x0, int y0) {
  for (int y = 0; y < from.height; ++y) std::copy_n(from.at(0, y), std::size_t(from.width) * 3, to.at(x0, y0 + y));
}

std::vector<std::string> lines_of(const CaseRow& row) {
  if (!row.fault.empty()) return {row.token, row.fault};
  std::string patient = row.patient_class.empty() ? "class not known" : row.patient_class;
  if (const std::string ml = figure_text(row, row.classed_by() + "_ml", 1); !ml.empty())
    patient += ", " + row.classed_by() + " " + ml + " ml";
  std::string indices;
  if (const std::string evans = figure_text(row, "evans_index_ratio", 2); !evans.empty()) indices = "Evans " + evans;
  if (const std::string shift = figure_text(row, "midline_shift_mm", 1); !shift.empty())
    indices += (indices.empty() ? "shift " : ", shift ") + shift + " mm";
  return {row.token, patient, indices,
          grouped_text(static_cast<long long>(row.triangles)) + " triangles, max " +
              fixed_text(row.deviation_max_mm, 2) + " mm" +
              (row.warnings.empty() ? "" : ", warnings: " + warnings_text(row))};
}

picture::Image cell_of(const fs::path& library, const CaseRow& row, int side) {
  const double capital_px = std::max(5.0, side * 0.042);
  const int line_px = static_cast<int>(std::lround(capital_px * 2)), lines = 4;
  const int height = side * 2 / 3;  // height of a case's pictures
  picture::Image cell(2 * side + 2, height + lines * line_px + line_px / 2, {1, 1, 1});
  const std::vector<std::string> pictures = overview_pictures(library, row);
  for (std::size_t i = 0; i < pictures.size(); ++i) try {
      const std::vector<char> png = read_file(library / pictures[i], max_png_bytes);
      paste(scaled(picture::decode_png({png.data(), png.size()}), side, height), cell, static_cast<int>(i) * (side + 2),
            0);
    } catch (const Error&) {  // a missing or damaged picture must not keep the others from being shown
    }
  const std::vector<std::string> text = lines_of(row);
  for (std::size_t i = 0; i < text.size(); ++i)
    picture::draw_text(cell, 4, height + line_px * (static_cast<double>(i) + 0.5), text[i], capital_px,
                       row.fault.empty() || i == 0 ? picture::Rgb{0.1, 0.1, 0.15} : picture::Rgb{0.75, 0.1, 0.1},
                       {1, 1, 1});
  return cell;
}

using Json = nlohmann::ordered_json;

// The figure as a number; nothing where the case has none.
void add_figure(const CaseRow& row, const std::string& name, const char* key, Json& out) {
  if (const ParameterValue* value = row.figure(name))
    if (const auto* number = std::get_if<double>(value)) out[key] = *number;
}

Json to_json(const fs::path& library, const CaseRow& row) {
  Json out;
  out["case"] = row.token;
  out["class"] = row.patient_class;
  out["fault"] = row.fault;
  if (!row.fault.empty())
    out["state"] = row.fault;
  else
    out["state"] = row.last.code == 0 ? "" : "last build failed with " + std::to_string(row.last.code);
  if (row.last.code != 0) out["fault"] = row.fault + (row.fault.empty() ? "" : "; ") + row.last.reason;
  out["warnings"] = row.warnings;
  out["severities"] = row.severities;
  out["pictures"] = Json::array();
  for (const std::string& file : overview_pictures(library, row))
    out["pictures"].push_back(file.substr(row.token.size() + 1));
  std::error_code ignored;
  out["page"] = row.fault.empty() && fs::exists(library / row.token / "report" / page::page_file, ignored);
  out["anatomies"] = Json::array();
  if (!row.fault.empty()) return out;
  out["triangles"] = row.triangles;
  out["deviation_mm"] = row.deviation_max_mm;
  add_figure(row, "evans_index_ratio", "evans", out);
  add_figure(row, "midline_shift_mm", "shift_mm", out);
  for (const cases::CaseAnatomy& a : row.manifest.anatomies)
    out["anatomies"].push_back({{"name", a.name},
                                {"triangles", a.triangles},
                                {"volume_ml", a.volume_ml},
                                {"deviation_mm", a.deviation.max_mm}});
  return out;
}

constexpr std::size_t max_volume_columns = 6;

// Counts in how many cases an anatomy is, to find those whose volumes have a column: those that most cases have.
class VolumeColumns {
 public:
  void add(const CaseRow& row) {
    for (const cases::CaseAnatomy& a : row.manifest.anatomies) {
      const auto [at, is_new] = place_.try_emplace(a.name, counts_.size());
      if (is_new) counts_.emplace_back(0, a.name);
      ++counts_[at->second].first;
    }
  }
  std::vector<std::string> names() const {
    auto counts = counts_;
    std::stable_sort(counts.begin(), counts.end(), [](const auto& a, const auto& b) { return a.first > b.first; });
    std::vector<std::string> out;
    for (std::size_t i = 0; i < std::min(counts.size(), max_volume_columns); ++i) out.push_back(counts[i].second);
    return out;
  }

 private:
  std::vector<std::pair<std::size_t, std::string>> counts_;  // in the order in which the cases name them
  std::map<std::string, std::size_t> place_;
};

// Where the cases stand in the picture: in rows of equally large cells.
struct Layout {
  int side = 0, columns = 0, lines = 0, gap = 0;
  explicit Layout(std::size_t count) {
    const double n = std::max<double>(1, static_cast<double>(count));
    side = std::clamp(static_cast<int>(std::sqrt(max_pixels / n / 2.9)), min_side_px, max_side_px);
    columns = static_cast<int>(std::min(n, std::max<double>(columns_count, std::floor(std::sqrt(n)))));
    lines = static_cast<int>((count + columns - 1) / static_cast<std::size_t>(columns));
    gap = side / 15;
  }
};

}  // namespace

std::vector<std::string> overview_pictures(const fs::path& library, const CaseRow& row) {
  std::vector<std::string> out;
  std::error_code ignored;
  // Those of a case that an older program made are collages, and small ones here.
  for (const std::vector<const char*>& names : {std::vector<const char*>{"cut", "overview"}, {"middle", "axial"}})
    for (const char* name : names) {
      const std::string file = row.token + "/report/" + name + ".png";
      if (!row.fault.empty() || !fs::exists(library / file, ignored)) continue;
      out.push_back(file);
      break;
    }
  return out;
}

Sheet sheet_of(const fs::path& library, std::size_t count, const std::function<CaseRow(std::size_t)>& row) {
  const Layout layout(count);
  const picture::Image empty = cell_of(library, {}, layout.side);
  const int width = layout.columns * (empty.width + layout.gap) + layout.gap, height = empty.height + layout.gap;
  PngRows png(width, std::max(layout.lines, 1) * height + layout.gap, 3);
  png.add(picture::Image(width, layout.gap, {1, 1, 1}).rgb);
  if (count == 0) png.add(picture::Image(width, height, {1, 1, 1}).rgb);
  VolumeColumns columns;
  std::string cases;
  for (std::size_t from = 0; from < count; from += static_cast<std::size_t>(layout.columns)) {
    std::vector<CaseRow> rows(std::min(static_cast<std::size_t>(layout.columns), count - from));
    picture::Image band(width, height, {1, 1, 1});
    parallel_for(0, static_cast<std::int64_t>(rows.size()), 1, [&](std::int64_t begin, std::int64_t end) {
      for (auto i = static_cast<std::size_t>(begin); i < static_cast<std::size_t>(end); ++i) {
        rows[i] = row(from + i);
        paste(cell_of(library, rows[i], layout.side), band,
              layout.gap + static_cast<int>(i) * (empty.width + layout.gap), 0);
      }
    });
    png.add(band.rgb);
    for (const CaseRow& r : rows) {
      columns.add(r);
      cases += (cases.empty() ? "" : ",") + to_json(library, r).dump();
    }
  }
  const std::string data = "{\"volumes\":" + Json(columns.names()).dump() + ",\"cases\":[" + cases + "]}";
  return {png.take(), page::html_page(page::web::index_html, page::web::index_css, page::web::index_js, data, {})};
}

void make_sheet(const fs::path& library) {
  const std::vector<std::string> tokens = library_tokens(library);
  const Sheet sheet = sheet_of(library, tokens.size(), [&](std::size_t i) { return read_row(library, tokens[i]); });
  write_file(library / picture_name, sheet.png);
  write_file(library / index_name, sheet.html);
}

bool has_sheet(const fs::path& library) {
  std::error_code ignored;
  return fs::exists(library / picture_name, ignored) && fs::exists(library / index_name, ignored);
}

}  // namespace trephine::library
