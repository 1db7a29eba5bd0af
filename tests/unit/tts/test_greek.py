"""Greek words to phones."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from fapstream.tts.greek import greek
from fapstream.tts.tables import phone_set


@pytest.mark.parametrize(
    ("word", "phones"),
    [
        ("καλημέρα", "k a0 l i0 m e1 r a0"),
        ("ευχαριστώ", "e0 f x a0 r i0 s t o1"),
        ("αύριο", "a1 v r i0 o0"),
        ("κόσμοσ", "k o1 z m o0 s"),
        ("άγγελοσ", "a1 N gj e0 l o0 s"),
        ("γκολ", "g o1 l"),
        ("μπαμπάσ", "b a0 b a1 s"),
        ("παιδιά", "p e0 D j a1"),
        ("χέρι", "C e1 r i0"),
        ("χαρά", "x a0 r a1"),
        ("εκκλησία", "e0 k l i0 s i1 a0"),
        ("ξύλο", "k s i1 l o0"),
        ("μια", "m J a0"),
        ("ποιοσ", "p C o1 s"),
        ("χιόνι", "C o1 n i0"),
        ("γιορτή", "j o0 r t i1"),
        ("μαϊμού", "m a0 i0 m u1"),
        ("τζάμι", "dz a1 m i0"),
        ("καλημερα", "k a0 l i0 m e1 r a0"),
        ("του", "t u0"),
        ("φωσ", "f o1 s"),
        ("Β", "v i1 t a0"),
    ],
)
def test_words(word: str, phones: str) -> None:
    assert " ".join(greek().word(word)) == phones


TOPICS = {
    "said in one syllable": """
        εννιακόσια e0 J a0 k o1 s C a0
        εννιά e0 J a1
        ασημένιοσ a0 s i0 m e1 J o0 s
        χρυσαφένιοι x r i0 s a0 f e1 J i0
        αρνίσιοσ a0 r n i1 s C o0 s
        ίσιοσ i1 s C o0 s
        ισιώνω i0 s C o1 n o0
        φτυάρι f t C a1 r i0
        φτιαγμένοσ f t C a0 G m e1 n o0 s
        χωριανόσ x o0 r j a0 n o1 s
        χωριάτησ x o0 r j a1 t i0 s
        θειάφι T C a1 f i0
        σμυρνιώτικοσ z m i0 r J o1 t i0 k o0 s
        σταφιδιάζω s t a0 f i0 D j a1 z o0
        μονοιάζω m o0 J a1 z o0
        θεριεύω T e0 r j e1 v o0
        φιλιώνω f i0 L o1 n o0
        βαριοπούλα v a0 r j o0 p u1 l a0
        λιοστάσι L o0 s t a1 s i0
        καταπιώ k a0 t a0 p C o1
        διαολεμένοσ D j a0 o0 l e0 m e1 n o0 s
        διακονιάρησ D j a0 k o0 J a1 r i0 s
        αδιάβαστοσ a0 D j a1 v a0 s t o0 s
        διακόσιουσ D j a0 k o1 s C u0 s
        διακοσίων D j a0 k o0 s i1 o0 n
        διαβάστε D j a0 v a1 s t e0
        διαβάσει D j a0 v a1 s i0
        ποιοι p C i1
        μιάμιση m J a1 m i0 s i0
        καραμπινιέροσ k a0 r a0 m b i0 J e1 r o0 s
    """,
    "said in two syllables": """
        αρμένιοσ a0 r m e1 n i0 o0 s
        σελένιο s e0 l e1 n i0 o0
        αφροδίσιοσ a0 f r o0 D i1 s i0 o0 s
        διπλάσια D i0 p l a1 s i0 a0
        αξιέραστη a0 k s i0 e1 r a0 s t i0
        αδέξια a0 D e1 k s i0 a0
        θέσμια T e1 z m i0 a0
        εργοστάσια e0 r G o0 s t a1 s i0 a0
        τηλεσκόπια t i0 l e0 s k o1 p i0 a0
        εμφύλια e0 m f i1 l i0 a0
        εμβόλια e0 m v o1 l i0 a0
        παγκόσμια p a0 N g o1 z m i0 a0
        νότια n o1 t i0 a0
        παραμεθόριασ p a0 r a0 m e0 T o1 r i0 a0 s
        εγκωμιάζω e0 N g o0 m i0 a1 z o0
        ιδιάζων i0 D i0 a1 z o0 n
        παραβιάζουν p a0 r a0 v i0 a1 z u0 n
        αδιάσπαστοσ a0 D i0 a1 s p a0 s t o0 s
        αδιάκοποσ a0 D i0 a1 k o0 p o0 s
        ελευθεριών e0 l e0 f T e0 r i0 o1 n
        κυριών c i0 r i0 o1 n
        επιτόκια e0 p i0 t o1 c i0 a0
        επιτόκιο e0 p i0 t o1 c i0 o0
        ένφια e1 n f i0 a0
        διαβάσεισ D i0 a0 v a1 s i0 s
    """,
    "digraphs and diaeresis": """
        ουρανόσ        u0 r a0 n o1 s
        παιδεία        p e0 D i1 a0
        οικία          i0 c i1 a0
        υιόσ           i0 o1 s
        ταΐζω          t a0 i1 z o0
        παϊδάκια       p a0 i0 D a1 c a0
        προϋπόθεση     p r o0 i0 p o1 T e0 s i0
        ευφυΐα         e0 f i0 i1 a0
        αϋπνία         a0 i0 p n i1 a0
        ταΰγετοσ       t a0 i1 j e0 t o0 s
        μωυσήσ         m o0 i0 s i1 s
        άυλοσ          a1 i0 l o0 s
    """,
    "diphthongs are two vowels": """
        νεράιδα        n e0 r a1 i0 D a0
        αηδόνι         a0 i0 D o1 n i0
        ρολόι          r o0 l o1 i0
        κοροϊδεύω      k o0 r o0 i0 D e1 v o0
        τσάι           ts a1 i0
        βόηθα          v o1 i0 T a0
    """,
    "αυ, ευ, ηυ": """
        αυλή           a0 v l i1
        αυγό           a0 v G o1
        αυτόσ          a0 f t o1 s
        αύξηση         a1 f k s i0 s i0
        αυριανόσ       a0 v r i0 a0 n o1 s
        αυστηρόσ       a0 f s t i0 r o1 s
        ευχή           e0 f C i1
        ευχαριστώ      e0 f x a0 r i0 s t o1
        εύκολοσ        e1 f k o0 l o0 s
        εύθραυστοσ     e1 f T r a0 f s t o0 s
        ευφορία        e0 f o0 r i1 a0
        εύβοια         e1 v i0 a0
        ευαίσθητοσ     e0 v e1 s T i0 t o0 s
        εύοσμοσ        e1 v o0 z m o0 s
        εύρεση         e1 v r e0 s i0
        ευδαιμονία     e0 v D e0 m o0 n i1 a0
        ευζωία         e0 v z o0 i1 a0
        ευνοώ          e0 v n o0 o1
        ευπαθήσ        e0 f p a0 T i1 s
        ευψυχία        e0 f p s i0 C i1 a0
        εμπνευσμένοσ   e0 m b n e0 v z m e1 n o0 s
        εφηύρα         e0 f i1 v r a0
    """,
    "k, x, G before front vowels": """
        κήποσ          c i1 p o0 s
        κύμα           c i1 m a0
        κοινόσ         c i0 n o1 s
        κακό           k a0 k o1
        χέρι           C e1 r i0
        χώρα           x o1 r a0
        γέροσ          j e1 r o0 s
        γάμοσ          G a1 m o0 s
        γυναίκα        j i0 n e1 k a0
        λόγοι          l o1 j i0
    """,
    "gamma and what follows it": """
        άγγελοσ        a1 N gj e0 l o0 s
        αγκαλιά        a0 N g a0 L a1
        έγκυροσ        e1 N gj i0 r o0 s
        άγχοσ          a1 N x o0 s
        άγχει          a1 N C i0
        ελέγξω         e0 l e1 N k s o0
        σφίγξ          s f i1 N k s
        έγγραφο        e1 N G r a0 f o0
        συγγραφέασ     s i0 N G r a0 f e1 a0 s
        έγγαμοσ        e1 N G a0 m o0 s
        συγγνώμη       s i0 G n o1 m i0
        συγγενήσ       s i0 N gj e0 n i1 s
        κονγκό         k o0 N g o1
        γκρίζοσ        g r i1 z o0 s
        γκέμι          gj e1 m i0
        αργκό          a0 r g o1
    """,
    "double letters": """
        άλλοσ          a1 l o0 s
        γράμμα         G r a1 m a0
        εννέα          e0 n e1 a0
        θάλασσα        T a1 l a0 s a0
        κόκκινοσ       k o1 c i0 n o0 s
        εκκλησία       e0 k l i0 s i1 a0
        σάββατο        s a1 v a0 t o0
        ιππότησ        i0 p o1 t i0 s
        αττική         a0 t i0 c i1
        άρρωστοσ       a1 r o0 s t o0 s
    """,
    "s before voiced consonants": """
        κόσμοσ         k o1 z m o0 s
        σβήνω          z v i1 n o0
        σγουρόσ        z G u0 r o1 s
        ισραήλ         i0 z r a0 i1 l
        προσβολή       p r o0 z v o0 l i1
        ασλάνι         a0 s l a1 n i0
        άσπροσ         a1 s p r o0 s
        ισχύσ          i0 s C i1 s
    """,
    "nasals and stops": """
        λάμπα          l a1 m b a0
        κουμπί         k u0 m b i1
        πέντε          p e1 n d e0
        άντρασ         a1 n d r a0 s
        πέμπτη         p e1 m p t i0
        λάμψη          l a1 m p s i0
        σύμφωνο        s i1 m f o0 n o0
    """,
    "loans": """
        μπορώ          b o0 r o1
        ντύνω          d i1 n o0
        γκολ           g o1 l
        τζάμι          dz a1 m i0
        τσάι           ts a1 i0
        παντζάρι       p a0 n dz a1 r i0
        κοντσέρτο      k o0 n ts e1 r t o0
        σκορ           s k o1 r
        κλαμπ          k l a1 b
        σνομπ          s n o1 b
        μπλογκ         b l o1 g
        τζαζ           dz a1 z
        εξπρέσ         e0 k s p r e1 s
        σάντουιτσ      s a1 n d u0 i0 ts
        μαϊντανόσ      m a0 i0 d a0 n o1 s
        μπαμπάσ        b a0 b a1 s
        νταντά         d a0 d a1
        μπουντρούμι    b u0 d r u1 m i0
        ντοκιμαντέρ    d o0 c i0 m a0 d e1 r
        ραντεβού       r a0 d e0 v u1
        ρομπότ         r o0 b o1 t
        μοντέρνοσ      m o0 n d e1 r n o0 s
        μπάντα         b a1 n d a0
        μπάγκοσ        b a1 N g o0 s
        ράντζο         r a1 n dz o0
        βεντέτα        v e0 d e1 t a0
        κομπιούτερ     k o0 b j u1 t e0 r
        σίντνεϊ        s i1 d n e0 i0
        κουτσομπόλησ   k u0 ts o0 b o1 l i0 s
        ακομπανιάρω    a0 k o0 m p a0 J a1 r o0
    """,
    "an i in words without a tonos": """
        μιασ           m J a0 s
        ποιοσ          p C o1 s
        δυο            D j o1
        γιοσ           j o1 s
        πιο            p C o1
        γεια           j a1
        για            j a0
    """,
    "an i that is no syllable": """
        παιδιά         p e0 D j a1
        παιδιών        p e0 D j o1 n
        γιατρόσ        j a0 t r o1 s
        γυαλί          j a0 l i1
        μυαλό          m J a0 l o1
        ήλιοσ          i1 L o0 s
        ελιά           e0 L a1
        ελιέσ          e0 L e1 s
        δουλειά        D u0 L a1
        χιόνι          C o1 n i0
        νιώθω          J o1 T o0
        πιάτο          p C a1 t o0
        διαβάζω        D j a0 v a1 z o0
        διαμάντι       D j a0 m a1 n d i0
        αγκαλιάζω      a0 N g a0 L a1 z o0
        ντροπιασμένοσ  d r o0 p C a0 z m e1 n o0 s
        γελιέμαι       j e0 L e1 m e0
        μετριέμαι      m e0 t r j e1 m e0
        συναντιέμαι    s i0 n a0 n d j e1 m e0
        κορίτσια       k o0 r i1 ts C a0
        δόντια         D o1 n d j a0
        ψώνια          p s o1 J a0
        μάτια          m a1 t C a0
        νησιά          n i0 s C a1
        κυριακή        c i0 r j a0 c i1
        χιλιάδεσ       C i0 L a1 D e0 s
        ψωριάρησ       p s o0 r j a1 r i0 s
        μαφιόζοσ       m a0 f C o1 z o0 s
        γαλιόνι        G a0 L o1 n i0
        μπανιέρα       b a0 J e1 r a0
        σερβιέτα       s e0 r v j e1 t a0
        καινούριοσ     c e0 n u1 r j o0 s
        κάποιοσ        k a1 p C o0 s
        τέτοιοσ        t e1 t C o0 s
        λόγια          l o1 j a0
    """,
    "an i that is a syllable": """
        δύο            D i1 o0
        τρία           t r i1 a0
        διάρκεια       D i0 a1 r c i0 a0
        διαδρομή       D i0 a0 D r o0 m i1
        πατριώτησ      p a0 t r i0 o1 t i0 s
        χρειάζομαι     x r i0 a1 z o0 m e0
        διπλασιάζω     D i0 p l a0 s i0 a1 z o0
        εφοδιάζω       e0 f o0 D i0 a1 z o0
        σημειώνω       s i0 m i0 o1 n o0
        αλιεύω         a0 l i0 e1 v o0
        δημιουργόσ     D i0 m i0 u0 r G o1 s
        τεχνολογιών    t e0 x n o0 l o0 j i0 o1 n
        δημοκρατιών    D i0 m o0 k r a0 t i0 o1 n
        εργασιών       e0 r G a0 s i0 o1 n
        επιτυχιών      e0 p i0 t i0 C i0 o1 n
        χιλιετία       C i0 l i0 e0 t i1 a0
        δημόσιασ       D i0 m o1 s i0 a0 s
        σκιά           s c i0 a1
        αξιώ           a0 k s i0 o1
        άγιοσ          a1 j i0 o0 s
        ημερολόγια     i0 m e0 r o0 l o1 j a0
        ηλίθια         i0 l i1 T i0 a0
        σχέδια         s C e1 D i0 a0
        μυστήρια       m i0 s t i1 r i0 a0
        βοήθεια        v o0 i1 T i0 a0
        άπνοια         a1 p n i0 a0
        βασανίστρια    v a0 s a0 n i1 s t r i0 a0
    """,
    "learned endings": """
        πόλεωσ         p o1 l e0 o0 s
        βασιλεύσ       v a0 s i0 l e1 f s
        κυβερνήσεωσ    c i0 v e0 r n i1 s e0 o0 s
        ημέραι         i0 m e1 r e0
        εξάγεται       e0 k s a1 j e0 t e0
        ελλάσ          e0 l a1 s
        φάλαγξ         f a1 l a0 N k s
    """,
    "words without a tonos": """
        οργανισμοσ     o0 r G a0 n i0 z m o1 s
        πολιτικοσ      p o0 l i0 t i0 k o1 s
        πολιτικησ      p o0 l i0 t i0 c i1 s
        αποφαση        a0 p o1 f a0 s i0
        αποφασεισ      a0 p o0 f a1 s i0 s
        καθηγητησ      k a0 T i0 j i0 t i1 s
        οικονομια      i0 k o0 n o0 m i1 a0
        τραγουδισμενοσ t r a0 G u0 D i0 z m e1 n o0 s
        εργαζομενοσ    e0 r G a0 z o1 m e0 n o0 s
        προβλημα       p r o1 v l i0 m a0
        προβληματα     p r o0 v l i1 m a0 t a0
        κοινοτητα      c i0 n o1 t i0 t a0
        σχολειο        s x o0 l i1 o0
        κυριοσ         c i1 r i0 o0 s
        ερχεται        e1 r C e0 t e0
        ερχονται       e1 r x o0 n d e0
        εγω            e0 G o1
        αυτοσ          a0 f t o1 s
        παιδια         p e0 D j a1
        μια            m J a0
        ενα            e0 n a0
        ειναι          i0 n e0
        ωρα            o1 r a0
    """,
}


@pytest.mark.parametrize("topic", TOPICS)
def test_topics(topic: str) -> None:
    wanted = [line.split(maxsplit=1) for line in TOPICS[topic].strip().splitlines()]
    assert [[word, " ".join(greek().word(word))] for word, _ in wanted] == wanted


@pytest.mark.parametrize(
    ("phrase", "phones"),
    [
        ("τον πατέρα", "t o0 m | b a0 t e1 r a0"),
        ("την καρδιά", "t i0 N | g a0 r D j a1"),
        ("την κυρία", "t i0 N | gj i0 r i1 a0"),
        ("στην πόλη", "s t i0 m | b o1 l i0"),
        ("στον τοίχο", "s t o0 n | d i1 x o0"),
        ("δεν μπορώ", "D e0 m | b o0 r o1"),
        ("δεν παίζω", "D e0 m | b e1 z o0"),
        ("μην τρέχεισ", "m i0 n | d r e1 C i0 s"),
        ("σαν κύμα", "s a0 N | gj i1 m a0"),
        ("αν πασ", "a0 m | b a1 s"),
        ("όταν τελειώνει", "o1 t a0 n | d e0 l i0 o1 n i0"),
        ("έναν κήπο", "e1 n a0 N | gj i1 p o0"),
        ("τον ξένο", "t o0 N | g z e1 n o0"),
        ("την ψυχή", "t i0 m | b z i0 C i1"),
        ("τον τσιγγάνο", "t o0 n | dz i0 N g a1 n o0"),
        ("τον μπαμπά", "t o0 m | b a0 b a1"),
        ("την ντουλάπα", "t i0 n | d u0 l a1 p a0"),
        ("τον γκρεμό", "t o0 N | g r e0 m o1"),
        ("την άλλη", "t i0 n | a1 l i0"),
        ("τον φίλο", "t o0 n | f i1 l o0"),
        ("των παιδιών", "t o0 n | p e0 D j o1 n"),
        ("αυτόν πήρα", "a0 f t o1 n | p i1 r a0"),
        ("τουσ βλέπω", "t u0 z | v l e1 p o0"),
        ("τουσ παίρνω", "t u0 s | p e1 r n o0"),
        ("τισ μέρεσ μασ", "t i0 z | m e1 r e0 z | m a0 s"),
        ("τουσ μπαμπάδεσ", "t u0 z | b a0 b a1 D e0 s"),
        ("τισ ντομάτεσ", "t i0 z | d o0 m a1 t e0 s"),
        ("οι τζίτζικεσ", "i0 | dz i1 dz i0 c e0 s"),
        ("τουσ γκρίζουσ", "t u0 z | g r i1 z u0 s"),
        ("ο φαξ μασ", "o0 | f a1 g z | m a0 s"),
        ("κι εγώ", "c | e0 G o1"),
        ("κι", "c i0"),
        ("το αυτοκίνητό μου", "t o0 | a0 f t o0 c i1 n i0 t o1 | m u0"),
    ],
)
def test_words_act_on_each_other(phrase: str, phones: str) -> None:
    assert " | ".join(map(" ".join, greek().phones(phrase.split()))) == phones


LETTERS = "αβγδεζηθικλμνξοπρστυφχψωάέήίόύώϊϋΐΰ"
SPECIAL = ["τον", "την", "δεν", "σαν", "όταν", "τουσ", "κι", "γι", "φαξ"]
SPECIAL += ["ξένοσ", "ψυχή", "τσάι", "τζάμι", "μπορώ", "ντύνω", "γκολ", "κήποσ", "γη", "μέρα", "άλλη", "εγώ"]
A_WORD = st.one_of(st.sampled_from(SPECIAL), st.text(LETTERS, min_size=1, max_size=6))


@given(A_WORD, A_WORD)
def test_a_word_that_needs_no_next_has_its_phones_whatever_follows(before: str, word: str) -> None:
    if not greek().needs_next(word):
        alone = greek().phones([before, word])[1]
        followers = [*SPECIAL, *LETTERS, *(a + b for a in "μντγπκσ" for b in "πτκζσγμβ")]
        assert all(greek().phones([before, word, after])[1] == alone for after in followers)


@pytest.mark.parametrize(
    ("word", "needs"), [("το", False), ("τον", True), ("παιδιών", False), ("τουσ", True)]
)
def test_which_words_need_the_next(word: str, needs: bool) -> None:
    assert greek().needs_next(word) is needs


@given(st.lists(A_WORD, min_size=1, max_size=6))
def test_a_word_depends_on_its_neighbours_only(words: list[str]) -> None:
    padded = ["", *words, ""]
    for i, phones in enumerate(greek().phones(words), 1):
        around = [w for w in padded[i - 1 : i + 2] if w]
        assert phones == greek().phones(around)[1 if i > 1 else 0]


@given(st.lists(st.text("αβγδεζηθικλμνξοπρστυφχψωάέήίόύώϊϋΐΰ", min_size=1, max_size=15), max_size=6))
def test_any_letters_give_phones_of_the_language(words: list[str]) -> None:
    phones = phone_set("el")
    found = greek().phones(words)
    assert len(found) == len(words)
    for tokens in found:
        for token in tokens:
            name = token[:-1] if token[-1].isdigit() else token
            assert (phones[name].kind == "vowel") == token[-1].isdigit()
