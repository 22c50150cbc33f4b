// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>
#include <vector>

#include "config/said.h"
#include "library/engine.h"
#include "phantom/phantom.h"

namespace trephine::library {

/// The declaration of LIBRARY.yaml.

struct PhantomValues {
  phantom::HeadParams head;
  phantom::HardParams hard;
  phantom::ScanParams scan;
  phantom::SeriesParams series;
  phantom::TruthParams truth;
  phantom::BodyParams body;
  template <class V>
  static void describe(V& v) {
    using P = PhantomValues;
    v.all_of(&P::head);
    v.all_of(&P::hard);
    v.all_of(&P::scan);
    v.all_of(&P::series);
    v.all_of(&P::truth);
    v.all_of(&P::body);
  }
  phantom::PhantomParams params() const {
    phantom::PhantomParams out{head, scan, series, truth, {}, body, {}};
    out.head.hard = hard;
    return out;
  }
};

struct LibraryPhantomParams : PhantomValues {
  std::string name, config;
  Named<config::SaidValue> set;
  template <class V>
  static void describe(V& v) {
    using P = LibraryPhantomParams;
    v.text(&P::name, "name", "Name of the patient and of its cases.").is_required();
    v.text(&P::config, "config", "The phantom's own configuration, instead of the library's.").names("file");
    v.map(&P::set, "set", "The phantom's own parameters by their paths.");
    v.template all_of<PhantomValues>();
  }
};

struct LibraryPhantomsParams {
  PhantomValues shared;
  std::vector<LibraryPhantomParams> list;
  template <class V>
  static void describe(V& v) {
    using P = LibraryPhantomsParams;
    v.group(&P::shared, "shared", "Parameters of every phantom that does not set them itself.");
    v.list(&P::list, "list", "The phantoms.", [](const P& phantoms) {
       LibraryPhantomParams one;
       static_cast<PhantomValues&>(one) = phantoms.shared;
       return one;
     }).is_required();
  }
};

struct LibraryCaseParams {
  std::string case_token, series, landmarks_file, config;
  Named<config::SaidValue> set;
  template <class V>
  static void describe(V& v) {
    using P = LibraryCaseParams;
    v.text(&P::case_token, "case", "Name of the case: a-z, 0-9, _ and -; never a patient's name.").is_required();
    v.text(&P::series, "series", "Folder, ZIP archive or file with its CT series.").names("file");
    v.text(&P::landmarks_file, "landmarks_file", "A file of known landmarks.").names("file");
    v.text(&P::config, "config", "The case's own configuration, instead of the library's.").names("file");
    v.map(&P::set, "set", "The case's own parameters by their paths.");
  }
};

struct LibraryFileParams : config::VersionParams {
  std::string config;
  Named<config::SaidPath> configs;
  Named<config::SaidValue> set;
  std::vector<LibraryCaseParams> cases;
  std::vector<config::SaidValue> series;
  std::optional<LibraryPhantomsParams> phantoms;
  EngineParams engine;
  template <class V>
  static void describe(V& v) {
    using P = LibraryFileParams;
    v.template all_of<config::VersionParams>();
    v.text(&P::config, "config", "The configuration of every case that names none.").names("file");
    v.map(&P::configs, "configs",
          "Several configurations by name, instead of config: each patient becomes one case of each.")
        .names("name");
    v.map(&P::set, "set", "Parameters of every case, by their paths.");
    v.list(&P::cases, "cases", "The cases by name.");
    v.list(&P::series, "series",
           "Folders, each of which is a case; in the last part of the path * stands for any letters.");
    v.group(&P::phantoms, "phantoms", "Synthetic patients that the library makes.");
    v.group(&P::engine, "engine", "What builds the cases: this machine, or a cluster.");
  }
};

}  // namespace trephine::library
