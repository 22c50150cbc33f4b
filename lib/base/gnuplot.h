// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>

namespace trephine {

/// A picture that gnuplot draws: the script without `set terminal` and `set output`, the terminal as in "svg size
/// 900,400". The script holds its data itself (`$name << END`), and quotes what is not its own by gnuplot_text. The
/// same script gives the same bytes. Throws Error 70 naming gnuplot where it is missing or fails.
std::string gnuplot_picture(const std::string& terminal, const std::string& script);

/// The text in single quotes, for titles and labels that take no markup (`noenhanced`).
std::string gnuplot_text(const std::string& text);

/// Colours that are told apart also by the colour-blind (Okabe and Ito), by turns.
const char* gnuplot_colour(std::size_t n);

/// The two terminals of our pictures.
std::string gnuplot_svg(int width, int height);
std::string gnuplot_png(int width, int height);

}  // namespace trephine
