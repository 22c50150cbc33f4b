// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "dicom_synthetic.h"

namespace synthetic {

inline std::string item(const std::string& content, bool defined) {
  const std::string head = little(0xfffe, 2) + little(0xe000, 2);
  if (defined) return head + little(content.size(), 4) + content;
  return head + little(0xffffffff, 4) + content + little(0xfffe, 2) + little(0xe00d, 2) + little(0, 4);
}

inline void sequence(DataSet& d, std::uint32_t t, const std::vector<std::string>& items, bool defined) {
  std::string content;
  for (const std::string& i : items) content += item(i, defined);
  if (!defined) content += little(0xfffe, 2) + little(0xe0dd, 2) + little(0, 4);
  d.elements[t] = {"SQ", content, {}};
  if (!defined) d.elements[t].claimed_length = 0xffffffff;
}

/// The scan's slices as frames of one file, in the order given.
inline DataSet enhanced(const Scan& s, const std::vector<int>& order, bool defined_lengths, bool explicit_vr = true) {
  DataSet d = s.slice(0);
  std::string pixels;
  std::vector<std::string> frames;
  for (const int k : order) {
    DataSet slice = s.slice(k);
    pixels += slice.elements[tag(0x7fe0, 0x10)].bytes;
    DataSet position, groups, hu;
    position.elements[tag(0x20, 0x32)] = slice.elements[tag(0x20, 0x32)];
    hu.elements[tag(0x28, 0x1052)] = slice.elements[tag(0x28, 0x1052)];
    hu.elements[tag(0x28, 0x1053)] = slice.elements[tag(0x28, 0x1053)];
    sequence(groups, tag(0x20, 0x9113), {position.bytes(explicit_vr)}, defined_lengths);
    sequence(groups, tag(0x28, 0x9145), {hu.bytes(explicit_vr)}, defined_lengths);
    frames.push_back(groups.bytes(explicit_vr));
  }
  DataSet orientation, measures, shared;
  orientation.elements[tag(0x20, 0x37)] = d.elements[tag(0x20, 0x37)];
  measures.elements[tag(0x18, 0x50)] = d.elements[tag(0x18, 0x50)];
  measures.elements[tag(0x28, 0x30)] = d.elements[tag(0x28, 0x30)];
  sequence(shared, tag(0x20, 0x9116), {orientation.bytes(explicit_vr)}, defined_lengths);
  sequence(shared, tag(0x28, 0x9110), {measures.bytes(explicit_vr)}, defined_lengths);
  for (const auto t :
       {tag(0x20, 0x32), tag(0x20, 0x37), tag(0x28, 0x30), tag(0x28, 0x1052), tag(0x28, 0x1053), tag(0x18, 0x50)})
    d.elements.erase(t);
  d.text(tag(0x8, 0x16), "UI", "1.2.840.10008.5.1.4.1.1.2.1");
  d.text(tag(0x28, 0x8), "IS", std::to_string(order.size()));
  sequence(d, tag(0x5200, 0x9229), {shared.bytes(explicit_vr)}, defined_lengths);
  sequence(d, tag(0x5200, 0x9230), frames, defined_lengths);
  d.elements[tag(0x7fe0, 0x10)] = {"OW", pixels, {}};
  return d;
}

}  // namespace synthetic
