// SPDX-License-Identifier: GPL-3.0-or-later
// What the rows of the score say, in each language.
#include "lessons/subclavian/subclavian_score.h"

#include "lessons/lesson_type.h"

namespace trephine::lessons {

std::vector<LessonText> subclavian_words() {
  return {
      {"Puncture of the skin", "Einstich in die Haut"},
      {"Direction of the needle", "Richtung der Nadel"},
      {"Blood from the vein", "Blut aus der Vene"},
      {"Artery", "Arterie"},
      {"Pleura and lung", "Pleura und Lunge"},
      {"Needle passes", "Durchgänge der Nadel"},
      {"the needle entered nothing", "die Nadel drang nirgends ein"},
      {"above the clavicle's lower border", "über dem Unterrand der Klavikula"},
      {"below the clavicle's lower border", "unter dem Unterrand der Klavikula"},
      {"too far below the clavicle", "zu weit unter der Klavikula"},
      {"toward the sternal notch", "zum Jugulum hin"},
      {"beside the sternal notch", "neben das Jugulum"},
      {"away from it", "davon weg"},
      {"the vein was never reached", "die Vene wurde nie erreicht"},
      {"blood was aspirated with the tip in the vein", "Blut wurde aspiriert, mit der Spitze in der Vene"},
      {"the tip lies in the vein, and nobody aspirated", "die Spitze liegt in der Vene, und niemand aspirierte"},
      {"the vein was entered, and left again", "die Vene wurde getroffen und wieder verlassen"},
      {"not entered", "nicht getroffen"},
      {"the artery was entered", "die Arterie wurde getroffen"},
      {"the pleura was entered", "die Pleura wurde verletzt"},
      {"the lung was entered", "die Lunge wurde verletzt"},
      {"as few as can be", "so wenige wie möglich"},
      {"several passes", "mehrere Durchgänge"},
      {"drawn at the syringe again and again", "immer wieder an der Spritze gezogen"},
      {"the needle went through the vein", "die Nadel ging durch die Vene hindurch"},
      {"no blood was drawn from the vein", "aus der Vene kam kein Blut"},
      {"the needle went in on the wrong side", "die Nadel ging auf der falschen Seite hinein"},
      {"the line lies in the vein", "der Katheter liegt in der Vene"},
      {"the line goes on beyond the vein that the case shows",
       "der Katheter geht über die Vene hinaus, die bekannt ist"},
      {"the line came into the vein", "der Katheter kam in die Vene"},
      {"the line came into no vein", "der Katheter kam in keine Vene"},
      {"what the CT shows of a line is doubtful", "was das CT von einem Katheter zeigt, ist zweifelhaft"},
      {"the CT shows no line there", "das CT zeigt dort keinen Katheter"},
      {"the case has none", "der Fall hat keine"},
      {"the case shows no lung on that side", "der Fall zeigt auf dieser Seite keine Lunge"},
      {"needle passes: {}, {}", "Durchgänge der Nadel: {}, {}"},
      {"green: success at the first pass", "grün: Erfolg beim ersten Durchgang"},
      {"green: blood from the vein", "grün: Blut aus der Vene"},
      {"red: failure", "rot: misslungen"},
      {"green", "grün"},
      {"red", "rot"},
  };
}

}  // namespace trephine::lessons
