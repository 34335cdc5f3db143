// SPDX-License-Identifier: Apache-2.0
// ATmega328P at 16 MHz (Arduino Uno and Nano): timer 1 starts a scan, the converter's interrupt reads one channel after the other, the
// UART's interrupt sends. Build options (-D): see ../Makefile.
#include "firmware/board.h"

#include <avr/eeprom.h>
#include <avr/interrupt.h>
#include <avr/io.h>
#include <avr/sleep.h>

namespace firmware {
namespace {

constexpr uint8_t kAdcFirst = _BV(REFS0);                                                 // reference: the 5 V supply, as AVCC
constexpr uint8_t kAdcOn = _BV(ADEN) | _BV(ADIE) | _BV(ADPS2) | _BV(ADPS1) | _BV(ADPS0);  // 125 kHz: 10 bit need at most 200 kHz
constexpr uint16_t kBaudRegister = (F_CPU / 8 + DTS_BAUD / 2) / DTS_BAUD - 1;             // with U2X
constexpr uint16_t kBeatsPerDescription = 5000000UL / 32768;                              // timer 1 overflows every 32.768 ms

static_assert(DTS_RATE >= 31 && DTS_RATE <= 1000, "RATE must be 31 to 1000 Hz: the period of a scan has 16 bits of ticks of 0.5 us");

uint8_t* run_cell(uint8_t cell) { return reinterpret_cast<uint8_t*>(static_cast<uint16_t>(cell)); }  // the EEPROM begins with the cells

/// Keeps interrupts out while it lives.
class NoInterrupts {
 public:
  NoInterrupts() : status_(SREG) { cli(); }
  ~NoInterrupts() { SREG = status_; }
  NoInterrupts(const NoInterrupts&) = delete;
  NoInterrupts& operator=(const NoInterrupts&) = delete;

 private:
  uint8_t status_;
};

class Hardware {
 public:
  using Guard = NoInterrupts;

  // A conversion takes 104 us, and its interrupt some 5 us. 8 channels take 0.9 ms.
  static constexpr Limits kLimits{DTS_CHANNELS, F_CPU / 8, DTS_IS_RATE_LIMITED ? F_CPU / 8 / 1000 : 1000, 0xFFFF,
                                  DTS_IS_RATE_LIMITED ? DTS_BAUD / 10 : 0};
  static constexpr uint8_t kBits = 10;
  static constexpr float kVoltsPerCode = 5.0F / 1024.0F;
  static constexpr uint8_t kQueuedScans = DTS_CHANNELS <= 4 ? 64 : 32;
  static constexpr uint32_t kFirstCounter = DTS_FIRST_COUNTER;
  static constexpr uint16_t kDefaultPeriod = F_CPU / 8 / DTS_RATE;

  static const char* serial() { return DTS_SERIAL; }
  static const char* model() { return "ATmega328P 10 bit"; }
  static const char* firmware() { return "dts-firmware " DTS_VERSION; }
  const char* channel_name(uint8_t channel) {
    name_[1] = static_cast<char>('0' + channel);
    return name_;
  }

  void begin();
  uint32_t start_sampling(uint16_t period);
  void stop_sampling() { TIMSK1 = _BV(TOIE1); }
  bool is_converting() const { return is_converting_; }
  void wake_line() { UCSR0B |= _BV(UDRIE0); }
  uint8_t read_cell(uint8_t cell) const { return eeprom_read_byte(run_cell(cell)); }
  void store_cell(uint8_t cell, uint8_t value) {
    cell_ = cell;
    cell_value_ = value;
    is_cell_due_ = true;
  }
  bool is_stored() const { return !is_cell_due_ && eeprom_is_ready(); }
  /// Begins the write that store_cell() asked for, if the EEPROM is ready. A write then takes 3.4 ms by itself.
  void store() {
    if (!is_cell_due_ || !eeprom_is_ready()) return;
    eeprom_write_byte(run_cell(cell_), cell_value_);
    is_cell_due_ = false;
  }
  void show(bool is_on) {
    if (is_on) {
      PORTB |= _BV(PORTB5);
    } else {
      PORTB &= static_cast<uint8_t>(~_BV(PORTB5));
    }
  }

  // From interrupts:
  void scan_due();
  void converted();
  void beat() { beats_ = beats_ + 1; }

  uint16_t beats() const {
    const NoInterrupts guard;
    return beats_;
  }

 private:
  uint32_t now() const;
  void convert(uint8_t channel) {
    ADMUX = kAdcFirst | channel;
    ADCSRA = kAdcOn | _BV(ADSC);
  }

  char name_[3] = "A0";
  uint16_t period_ = 0;
  int16_t* slot_ = nullptr;  ///< The scan that is being converted.
  uint8_t channel_ = 0;
  uint8_t cell_ = 0;
  uint8_t cell_value_ = 0;
  uint16_t late_ = 0;  ///< Scans that were due while another one was being converted.
  bool is_cell_due_ = false;
  volatile bool is_converting_ = false;
  volatile uint16_t beats_ = DTS_FIRST_TICKS >> 16;  ///< Overflows of timer 1: the upper half of the clock.
};

constexpr Limits Hardware::kLimits;

Hardware hardware;
Board<Hardware> board(hardware);
volatile bool has_work = true;  ///< An interrupt happened since the last poll().

void Hardware::begin() {
  DDRB |= _BV(DDB5);
  DIDR0 = 0x3F;  // no digital inputs on the analogue pins
  PRR = _BV(PRTWI) | _BV(PRTIM2) | _BV(PRTIM0) | _BV(PRSPI);
  ADMUX = kAdcFirst;
  ADCSRA = kAdcOn;
  UCSR0A = _BV(U2X0);
  UCSR0C = _BV(UCSZ01) | _BV(UCSZ00);
  UBRR0 = kBaudRegister;
  UCSR0B = _BV(RXCIE0) | _BV(RXEN0) | _BV(TXEN0);
  TCCR1A = 0;
  TIMSK1 = _BV(TOIE1);
  TCCR1B = _BV(CS11);  // 2 MHz, never stopped: the board's clock
}

/// Returns the clock. Call it with interrupts off.
uint32_t Hardware::now() const {
  uint16_t low = TCNT1;
  uint16_t high = beats_;
  if ((TIFR1 & _BV(TOV1)) != 0) {  // the overflow's interrupt is still due
    low = TCNT1;
    ++high;
  }
  return (static_cast<uint32_t>(high) << 16) | low;
}

uint32_t Hardware::start_sampling(uint16_t period) {
  const NoInterrupts guard;
  period_ = period;
  const uint32_t first = now() + 1000;
  OCR1A = static_cast<uint16_t>(first);
  TIFR1 = _BV(OCF1A);
  TIMSK1 = _BV(TOIE1) | _BV(OCIE1A);
  return first;
}

void Hardware::scan_due() {
  OCR1A = OCR1A + period_;
  if (is_converting_) {
    ++late_;
    return;
  }
  slot_ = board.scans.slot();
  if (slot_ == nullptr) {
    board.scans.lose(1, Reason::kBufferFull);
    return;
  }
  is_converting_ = true;
  channel_ = 0;
  convert(0);
}

void Hardware::converted() {
  slot_[channel_] = static_cast<int16_t>(ADC);
  if (++channel_ != DTS_CHANNELS) {
    convert(channel_);
    return;
  }
  board.scans.commit();
  if (late_ != 0) board.scans.lose(late_, Reason::kLate);  // after the scan that was in their way
  late_ = 0;
  is_converting_ = false;
}

}  // namespace
}  // namespace firmware

ISR(TIMER1_COMPA_vect) { firmware::hardware.scan_due(); }

ISR(TIMER1_OVF_vect) {
  firmware::hardware.beat();
  firmware::has_work = true;
}

ISR(ADC_vect) {
  firmware::hardware.converted();
  firmware::has_work = true;
}

ISR(USART_RX_vect) {
  const uint8_t status = UCSR0A;
  const uint8_t byte = UDR0;
  firmware::ByteRing& ring = firmware::board.from_host;
  // A byte with a framing error or without room is dropped: the CRC then rejects its command.
  if ((status & _BV(FE0)) == 0 && ring.room() != 0) {
    ring.add(byte);
    ring.publish();
  }
  firmware::has_work = true;
}

ISR(USART_UDRE_vect) {
  firmware::ByteRing& ring = firmware::board.to_host;
  if (ring.is_empty()) {
    UCSR0B &= static_cast<uint8_t>(~_BV(UDRIE0));
    firmware::has_work = true;
  } else {
    UDR0 = ring.take();
    firmware::has_work = true;
  }
}

int main() {
  using firmware::board;
  using firmware::hardware;
  hardware.begin();
  board.begin();
  sei();
  uint16_t described = hardware.beats();
  set_sleep_mode(SLEEP_MODE_IDLE);
  for (;;) {
    firmware::has_work = false;
    hardware.store();
    const uint16_t beats = hardware.beats();
    if (static_cast<uint16_t>(beats - described) >= firmware::kBeatsPerDescription) {
      described = beats;
      board.describe_again();
    }
    board.poll();
    hardware.show(board.is_led_on(beats));
    cli();
    if (!firmware::has_work) {
      sleep_enable();
      sei();  // the next instruction is executed before any interrupt
      sleep_cpu();
      sleep_disable();
    }
    sei();
  }
}
