// SPDX-License-Identifier: GPL-3.0-or-later
#include "texts/note.h"

#include "texts/phrase.h"

namespace trephine::texts {
namespace {

struct Row {
  NoteId id;
  Wording wording;
};

constexpr Row table[] = {
    {NoteId::verbatim, {{"{}", "{}"}}},
    {NoteId::fault_pose, {{"pose", "Lage"}}},
    {NoteId::fault_time_step, {{"time step", "Zeitschritt"}}},
    {NoteId::fault_force, {{"force", "Kraft"}}},
    {NoteId::fault_device_lost, {{"device lost", "Gerät verloren"}}},
    {NoteId::fault_jump, {{"jump", "Sprung"}}},
    {NoteId::fault_gap, {{"gap", "Lücke"}}},
    {NoteId::force_is_zero, {{"fault: {}: the force is zero from now on", "Fehler: {}: die Kraft ist ab jetzt null"}}},
    {NoteId::force_comes_back,
     {{"the device had a {}: no force until it is back", "am Gerät: {}: keine Kraft, bis es wieder folgt"}}},
    {NoteId::second_force_is_zero,
     {{"second hand, fault: {}: its force is zero from now on",
       "zweite Hand, Fehler: {}: ihre Kraft ist ab jetzt null"}}},
    {NoteId::second_force_comes_back,
     {{"second hand, {}: no force until its device is back",
       "zweite Hand, {}: keine Kraft, bis ihr Gerät wieder folgt"}}},
    {NoteId::waiting_for_device, {{"waiting for a device on {}", "warte auf ein Gerät an {}"}}},
    {NoteId::waiting_for_tracker, {{"waiting for the tracker at {}", "warte auf das Trackingsystem an {}"}}},
    {NoteId::softer_walls,
     {{"all that is touched has {} of its stiffness, since the device answers after {} ms and damps by {} N s/m",
       "alles Berührte hat das {}-fache seiner Steife, denn das Gerät antwortet nach {} ms und dämpft mit {} N s/m"}}},
    {NoteId::undamped_device,
     {{"the device's damping is not known: a wall yields to a lasting press",
       "die Dämpfung des Geräts ist nicht bekannt: Eine lang gedrückte Wand gibt nach"}}},
    {NoteId::mesh_not_cut,
     {{"{} is touched as a surface beside the volume: a drill is held by it and does not cut it",
       "{} wird als Fläche neben dem Volumen berührt: Ein Bohrer wird davon gehalten und schneidet es nicht"}}},
    {NoteId::holding_mouse_3d, {{"holding a 3D mouse", "eine 3D-Maus hält das Instrument"}}},
    {NoteId::holding, {{"holding {}", "{} hält das Instrument"}}},
    {NoteId::coarse_beyond,
     {{"beyond {} mm of the tool {} is shown coarse: {} of {} triangles, {} places measured, the worst {} mm off",
       "weiter als {} mm vom Instrument ist {} grob gezeigt: {} von {} Dreiecken, {} Stellen gemessen, die "
       "schlechteste "
       "{} mm daneben"}}},
    {NoteId::coarse,
     {{"{} is shown coarse: {} of {} triangles, {} places measured, the worst {} mm off",
       "{} ist grob gezeigt: {} von {} Dreiecken, {} Stellen gemessen, die schlechteste {} mm daneben"}}},
    {NoteId::memory_coarse,
     {{"graphics memory: {} shown coarse: {} of {} triangles, {} places measured, the worst {} mm off",
       "Grafikspeicher: {} grob gezeigt: {} von {} Dreiecken, {} Stellen gemessen, die schlechteste {} mm daneben"}}},
    {NoteId::memory_edges, {{"graphics memory: rough edges", "Grafikspeicher: raue Kanten"}}},
    {NoteId::memory_no_ct,
     {{"graphics memory: no CT on cuts and slices", "Grafikspeicher: kein CT in Schnitten und Schichten"}}},
    {NoteId::memory_ct, {{"graphics memory: the CT in voxels of {} mm", "Grafikspeicher: das CT in Voxeln von {} mm"}}},
    {NoteId::memory_old_incisions,
     {{"graphics memory: the oldest incisions look closed, and are not",
       "Grafikspeicher: die ältesten Inzisionen sehen geschlossen aus und sind es nicht"}}},
    {NoteId::memory_new_incision,
     {{"graphics memory: the newest incision takes {} MB more than graphics_budget_mb",
       "Grafikspeicher: die neueste Inzision braucht {} MB mehr als graphics_budget_mb"}}},
    {NoteId::memory_pictures,
     {{"graphics memory: pictures of {} x {} pixels in place of {} x {}",
       "Grafikspeicher: Bilder von {} x {} Bildpunkten statt {} x {}"}}},
    {NoteId::many_incisions,
     {{"more than {} incisions: the oldest look closed, and are not",
       "mehr als {} Inzisionen: die ältesten sehen geschlossen aus und sind es nicht"}}},
    {NoteId::frames_lost,
     {{"{} frames were not recorded: the disk is too slow",
       "{} Zeitschritte fehlen in der Aufnahme: die Platte ist zu langsam"}}},
    {NoteId::ticks,
     {{"{}: {} ticks, tick time p50 {}, p99 {} us, woken late p50 {}, p99 {} ms, {} overruns",
       "{}: {} Takte, Dauer p50 {}, p99 {} us, verspätet p50 {}, p99 {} ms, {} zu lange"}}},
    {NoteId::ticks_with_faults,
     {{"{}: {} ticks, tick time p50 {}, p99 {} us, woken late p50 {}, p99 {} ms, {} overruns, faults {}",
       "{}: {} Takte, Dauer p50 {}, p99 {} us, verspätet p50 {}, p99 {} ms, {} zu lange, Fehler: {}"}}},
    {NoteId::removed, {{"{} removed {}", "{} hat entfernt: {}"}}},
    {NoteId::target_followed,
     {{"target followed for {} s: {} mm off in the mean, behind by {} mm ({} s)",
       "Ziel {} s lang verfolgt: im Mittel {} mm daneben, {} mm ({} s) dahinter"}}},
    {NoteId::outcome_not_completed, {{"not completed", "nicht vollendet"}}},
    {NoteId::outcome_completed, {{"completed", "vollendet"}}},
    {NoteId::outcome_failed, {{"failed", "nicht bestanden"}}},
    {NoteId::judged,
     {{"the lesson is judged: {} of {} points, {}", "die Lektion ist bewertet: {} von {} Punkten, {}"}}},
    {NoteId::judged_in,
     {{"the lesson is judged in {}: {} of {} points, {}", "die Lektion ist bewertet in {}: {} von {} Punkten, {}"}}},
    {NoteId::file_not_written,
     {{"a file could not be written: {}: {}", "eine Datei konnte nicht geschrieben werden: {}: {}"}}},
    {NoteId::nothing_there, {{"nothing is there", "da ist nichts"}}},
    {NoteId::no_volume,
     {{"the case has neither a CT nor a haptic volume of raw HU",
       "es gibt weder ein CT noch ein haptisches Volumen aus HU"}}},
    {NoteId::nothing_cast, {{"no rays are cast through HU", "es gehen keine Strahlen durch HU"}}},
    {NoteId::several_functions,
     {{"each shape has a function of its own: begin with one of them, or with a preset",
       "jede Form hat eine eigene Funktion: mit einer davon beginnen, oder mit einer Vorgabe"}}},
    {NoteId::no_transfer_point, {{"{}: the function has points 1 to {}", "{}: die Funktion hat die Punkte 1 bis {}"}}},
    {NoteId::no_more_points,
     {{"no point is added: there are two at these HU, or 64 in all",
       "kein weiterer Punkt: dort sind zwei, oder es sind 64"}}},
    {NoteId::no_lesson, {{"this is no lesson", "das ist keine Lektion"}}},
    {NoteId::no_arm, {{"this lesson has no C-arm", "diese Lektion hat keinen C-Bogen"}}},
    {NoteId::no_ct,
     {{"the case holds no CT, so there are no X-rays", "der Fall enthält kein CT, also keine Durchleuchtung"}}},
    {NoteId::no_target, {{"the case has no target", "der Fall hat kein Ziel"}}},
    {NoteId::no_view, {{"{}: there is no such view", "{}: diese Ansicht gibt es nicht"}}},
    {NoteId::no_cut,
     {{"{}: a cut is none, tool, axial, coronal or sagittal",
       "{}: ein Schnitt ist none, tool, axial, coronal oder sagittal"}}},
    {NoteId::no_arm_place,
     {{"{}: the arm goes to ap, lateral, oblique, or by orbit_more, orbit_less, tilt_more, tilt_less",
       "{}: der C-Bogen geht nach ap, lateral, oblique, oder um orbit_more, orbit_less, tilt_more, tilt_less"}}},
    {NoteId::no_anatomy, {{"{}: the case shows none of that name", "{}: der Fall zeigt nichts dieses Namens"}}},
    {NoteId::no_opacity, {{"an opacity is a number from 0 to 1", "eine Deckkraft ist eine Zahl von 0 bis 1"}}},
    {NoteId::no_tool_of_lesson, {{"{}: the lesson has no such tool", "{}: dieses Instrument hat die Lektion nicht"}}},
    {NoteId::no_lesson_command, {{"{}: there is no such command", "{}: diesen Befehl gibt es nicht"}}},
    {NoteId::no_command, {{"{}: no such command", "{}: kein solcher Befehl"}}},
    {NoteId::recording_shown, {{"a recording is shown", "eine Aufnahme wird gezeigt"}}},
    {NoteId::after_lesson, {{"not before the lesson's end", "nicht vor dem Ende der Lektion"}}},
    {NoteId::enter_again, {{"Enter again: the lesson ends", "noch einmal Eingabe: die Lektion endet"}}},
    {NoteId::only_end_left, {{"only the end is left: press Enter twice", "es bleibt nur das Ende: zweimal Eingabe"}}},
    {NoteId::lesson_is_paused, {{"the lesson is paused: go on first", "die Lektion ist angehalten: erst weiter"}}},
    {NoteId::questions_first,
     {{"answer the questions first, or end once more", "erst die Fragen beantworten, oder noch einmal beenden"}}},
    {NoteId::no_question, {{"nothing is asked now", "jetzt wird nichts gefragt"}}},
    {NoteId::no_answer, {{"{}: the question has no such answer", "{}: diese Antwort hat die Frage nicht"}}},
    {NoteId::marker_untouched, {{"the marker has not touched yet", "der Stift hat noch nichts berührt"}}},
    {NoteId::last_step, {{"this is the last step", "das ist der letzte Schritt"}}},
    {NoteId::first_step, {{"this is the first step", "das ist der erste Schritt"}}},
    {NoteId::choose_tool,
     {{"the next step has several tools: take one by its figure",
       "der nächste Schritt hat mehrere Instrumente: eines mit seiner Ziffer nehmen"}}},
    {NoteId::no_other_burr, {{"there is no such burr here", "diesen Bohrer gibt es hier nicht"}}},
    {NoteId::not_now,
     {{"not now: the lesson waits for its device, or has ended",
       "nicht jetzt: die Lektion wartet auf ihr Gerät oder ist zu Ende"}}},
};

constexpr bool complete() {
  for (int n = 0; n < int(NoteId::count); ++n)
    if (n >= int(sizeof table / sizeof *table) || table[n].id != NoteId(n)) return false;
  return true;
}
static_assert(complete(), "one wording for each note, in the order of NoteId");

}  // namespace

bool operator==(const Note& a, const Note& b) { return a.id == b.id && a.values == b.values && a.words == b.words; }

const Wording& wording_of(NoteId id) { return table[std::size_t(id)].wording; }

bool is_for_log(NoteId id) {
  return (id >= NoteId::coarse_beyond && id <= NoteId::memory_pictures) || id == NoteId::ticks;
}

std::string text_of(const Note& note, Language language) {
  std::vector<std::string> values = note.values;
  std::string listed;
  for (const NoteId word : note.words) listed += (listed.empty() ? "" : ", ") + text_of(word, language);
  if (!note.words.empty()) values.push_back(listed);
  return filled(wording_of(note.id).of(language), values);
}

}  // namespace trephine::texts
