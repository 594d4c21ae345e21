// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "lib/lens_file/code_v_text_internal.h"

namespace sagitta::lens_file {
namespace {

bool is_digit(char c) { return c >= '0' && c <= '9'; }
bool all_digits(std::string_view text) { return !text.empty() && std::all_of(text.begin(), text.end(), is_digit); }

class Splitter {
 public:
  explicit Splitter(std::string_view text) : text_(text) {}

  std::vector<Statement> split() {
    while (at_ < text_.size()) {
      const char c = text_[at_];
      if (c == '\n' || c == '\r') end_line();
      else if (c == ';') end_statement(), ++at_;
      else if (c == '!') at_ = end_of_line();
      else if (c == '&' && trimmed(text_.substr(at_ + 1, end_of_line() - at_ - 1)).empty()) at_ = end_of_line(), goes_on_ = true;
      else if (blanks.find(c) != std::string_view::npos) ++at_;
      else take_word();
    }
    end_statement();
    return std::move(statements_);
  }

 private:
  std::size_t end_of_line() const { return std::min(text_.find_first_of("\r\n", at_), text_.size()); }
  void end_line() {
    if (!goes_on_) end_statement();
    goes_on_ = false;
    at_ += text_.substr(at_).starts_with("\r\n") ? 2 : 1;
    line_begin_ = at_;
    ++line_;
  }
  void end_statement() {
    if (!words_.empty()) {
      std::string rest;
      for (std::size_t i = 1; i < words_.size(); ++i) rest += (i > 1 ? " " : "") + words_[i].text;
      statements_.push_back({std::move(words_), std::move(rest), false});
    }
    words_.clear();
  }
  void take_word() {
    Word word{{}, line_, static_cast<int>(at_ - line_begin_) + 1, false};
    const auto is_quote = [](char c) { return c == '\'' || c == '"'; };
    word.quoted = is_quote(text_[at_]);
    const std::size_t last = end_of_line();
    while (at_ < last && blanks.find(text_[at_]) == std::string_view::npos && text_[at_] != ';' && text_[at_] != '!' &&
           !(text_[at_] == '&' && trimmed(text_.substr(at_ + 1, last - at_ - 1)).empty())) {
      if (!is_quote(text_[at_])) {
        word.text += text_[at_++];
        continue;
      }
      const std::size_t end = std::min(text_.find(text_[at_], at_ + 1), last);  // an open quote ends with its line
      word.text += word.quoted ? text_.substr(at_ + 1, end - at_ - 1) : text_.substr(at_, std::min(end + 1, last) - at_);
      at_ = std::min(end + 1, last);
    }
    words_.push_back(std::move(word));
  }

  std::string_view text_;
  std::size_t at_ = 0, line_begin_ = 0;
  int line_ = 1;
  bool goes_on_ = false;
  std::vector<Word> words_;
  std::vector<Statement> statements_;
};

}  // namespace

std::vector<Statement> code_v_statements(std::string_view text) { return Splitter(text).split(); }

std::string upper(std::string_view text) {
  std::string result(text);
  std::transform(result.begin(), result.end(), result.begin(), [](char c) { return c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c; });
  return result;
}

bool is_surface_name(std::string_view name) { return name == "S" || name == "SO" || name == "SI" || (name.starts_with("S") && all_digits(name.substr(1))); }

std::string command_name(std::string_view given) {
  const std::string name = upper(given);
  return is_surface_name(name) ? name : name.substr(0, 3);
}

std::optional<GlassCode> glass_code(std::string_view text) {
  const std::size_t point = text.find('.');
  std::string_view before = text.substr(0, point), behind = point == std::string_view::npos ? std::string_view() : text.substr(point + 1);
  if (point == std::string_view::npos && text.size() == 6) before = text.substr(0, 3), behind = text.substr(3);
  if (before.size() < 3 || before.size() > 12 || behind.size() > 12 || !all_digits(before) || !all_digits(behind)) return std::nullopt;
  const Real nd = 1 + *parse_real(before) / power(10, static_cast<int>(before.size())), vd = *parse_real(behind) / power(10, static_cast<int>(behind.size()) - 2);
  if (!(vd > 0)) return std::nullopt;
  return GlassCode{static_cast<double>(nd), static_cast<double>(vd)};
}

}  // namespace sagitta::lens_file
