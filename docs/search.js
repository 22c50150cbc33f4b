// SPDX-License-Identifier: GPL-3.0-or-later
// The search of the site. A page that is opened from a folder (file://) may neither fetch a file nor start a worker, so the index is a
// script, search/index.js, which is loaded with the first search. Every word of the query must be in a section; a title counts most.
(function () {
  "use strict";
  var most = 30, around = 70;
  var sections = null, waiting = [];

  function withSections(use) {
    if (sections) return use();
    waiting.push(use);
    if (waiting.length > 1) return;
    var script = document.createElement("script");
    script.src = base_url + "/search/index.js";
    script.onload = function () {
      sections = window.search_sections.map(function (s) {
        return { place: s[0], page: s[1], title: s[2], text: s[3], lower: s[3].toLowerCase(), heading: (s[1] + " " + s[2]).toLowerCase() };
      });
      waiting.splice(0).forEach(function (next) { next(); });
    };
    document.head.appendChild(script);
  }

  function count(text, word) {
    return text.split(word).length - 1;
  }

  function found(query) {
    var words = query.toLowerCase().split(/\s+/).filter(function (w) { return w.length > 1; });
    if (!words.length) return [];
    var hits = [];
    sections.forEach(function (s) {
      var score = 0;
      for (var i = 0; i < words.length; i++) {
        var titles = count(s.heading, words[i]), texts = count(s.lower, words[i]);
        if (!titles && !texts) return;
        score += 20 * titles + Math.min(texts, 10);
      }
      hits.push({ section: s, score: score, word: words[0] });
    });
    return hits.sort(function (a, b) { return b.score - a.score; }).slice(0, most);
  }

  function show(hits) {
    var list = document.getElementById("mkdocs-search-results");
    list.textContent = hits.length ? "" : list.getAttribute("data-no-results-text");
    hits.forEach(function (hit) {
      var s = hit.section, at = Math.max(0, s.lower.indexOf(hit.word) - around);
      var article = document.createElement("article"), heading = document.createElement("h3");
      var link = document.createElement("a"), text = document.createElement("p");
      link.href = base_url + "/" + s.place;
      link.textContent = s.title === s.page ? s.page : s.page + ": " + s.title;
      text.textContent = (at ? "... " : "") + s.text.slice(at, at + 3 * around) + " ...";
      heading.appendChild(link);
      article.appendChild(heading);
      article.appendChild(text);
      list.appendChild(article);
    });
  }

  function search() {
    var query = document.getElementById("mkdocs-search-query").value;
    withSections(function () { show(found(query)); });
  }

  document.addEventListener("DOMContentLoaded", function () {
    var input = document.getElementById("mkdocs-search-query");
    if (!input) return;
    input.addEventListener("input", search);
    var asked = new URLSearchParams(window.location.search).get("q");
    if (asked) {
      input.value = asked;
      search();
    }
  });
})();
